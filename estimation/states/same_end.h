#pragma once

#include <span>

#include "estimation/states/fit.h"

namespace hydroscope {

/// Whether a start of a fit's model leads where that ended: parameters alike, the squares of its errors over the fit's noise no
/// further from the fit's than a share `same_minimum` of them.
bool IsWhereItEnded(const StateFit& fit, std::span<const Episode> episodes, const StateStart& start,
                    double same_minimum);

}  // namespace hydroscope
