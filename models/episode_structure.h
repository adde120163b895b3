#pragma once

#include <memory>

#include "models/model_structure.h"

namespace hydroscope {

/// A machine that is judged in episodes (InEpisodes) as those who store and judge strokes see it. About the parameters at which
/// an episode is linearised,
///   errors over noise + slopes * parameters = slopes * parameters + what is left,
/// a balance that is linear in the parameters, those of effects of the model included: slopes are the columns, the left side is
/// the output. Episodes leave its sums of products behind as strokes do (StrokeGram), and later fits need no raw log. Its
/// columns cannot be filled sample by sample: they come from whole episodes (pipeline/episode_pipeline.h).
Result<std::shared_ptr<ModelStructure>> BuildEpisodeStructure(const Machine& machine);

}  // namespace hydroscope
