#pragma once

#include "models/model_structure.h"

namespace hydroscope {

/// Adds shapes of `effect` between those its grid has, `parts` - 1 between each two neighbours: the regressor
/// at a value between two grid values is taken as the straight line between theirs (error of second order in
/// the distance). Needs no further columns, so it works on stored Grams. Neighbours differ in one nonlinear
/// parameter only; an effect without such stays as it is.
void AddInterpolatedShapes(ModelStructure& model, int effect, int parts = 4);

}  // namespace hydroscope
