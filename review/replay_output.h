#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "review/replay_runner.h"

namespace hydroscope {

/// Table of the logs, parameters with intervals, what was skipped and why, files written, what to do next: of
/// each machine, then what its axes show together.
std::string ReplayText(const ReplayOptions& options, const PressReplay& replay);
/// The JSON of docs/command_line.md.
nlohmann::json ReplayJson(const ReplayOptions& options, const PressReplay& replay);

}  // namespace hydroscope
