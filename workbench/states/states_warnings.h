#pragma once

#include <vector>

#include "workbench/states/states_log.h"

namespace hydroscope {

/// What makes the fit of a machine with states doubtful, a sentence each.
std::vector<Told> FitWarnings(const StatesFit& fit);
/// ... and what is said beside the verdict of `explain`.
std::vector<Told> ExplainWarnings(const StatesExplained& explained);

}  // namespace hydroscope
