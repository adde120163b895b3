#pragma once

#include <optional>
#include <string>
#include <vector>

#include "models/machine.h"
#include "setup/log_columns.h"

namespace hydroscope {

/// Turns `z` and `y_v` of a die cushion the model's way round: in a drawing stroke (pressure high, cushion
/// moving) the position falls and the spool is positive. Returns what was found, one sentence each. `seconds`
/// is the time between rows.
std::vector<std::string> TurnCushionSignals(const LogColumns& head, double seconds, Machine& machine);

}  // namespace hydroscope
