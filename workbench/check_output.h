#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "workbench/check_log.h"

namespace hydroscope {

/// Signals, sampling, gate, identifiability and hints as aligned tables with units.
std::string CheckText(const CheckResult& check, const std::string& machine_file);
/// The JSON of docs/command_line.md.
nlohmann::json CheckJson(const CheckResult& check);

}  // namespace hydroscope
