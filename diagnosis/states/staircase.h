#pragma once

#include <string>
#include <utility>
#include <vector>

#include "diagnosis/states/state_candidate.h"

namespace hydroscope {

/// Effect added ("" = none) and ErrorLeftOut, from the model as it is to a set that was found; `levels`: per number of effects,
/// sets best first. The best of a size may hold an effect that is not in the set found, and is no step on the way then.
std::vector<std::pair<std::string, double>> StaircaseTo(
    const StateCandidate& found, const std::vector<std::vector<StateCandidate>>& levels);

}  // namespace hydroscope
