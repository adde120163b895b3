#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "models/machine.h"
#include "workbench/frequency_response/valve_log.h"

namespace hydroscope {

/// Result of `frf` for people: table of points, model with 95 % intervals and units, warnings, a hint if the
/// amplitude was too large.
std::string ValveText(const ValveLog& measured, const Machine& machine);

/// Result of `frf` for scripts, keys as documented in docs/frequency_response.md.
nlohmann::json ValveJson(const ValveLog& measured, const Machine& machine);

}  // namespace hydroscope
