#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "core/result.h"

namespace hydroscope {

/// Where the log of a simulated machine goes, and its truth.
struct SimulatedLogFiles {
  std::string out, truth;
};

/// --out and --truth.
void AddFiles(CLI::App& app, SimulatedLogFiles& files);

/// Errors: a file cannot be written.
Status WriteSimulated(const SimulatedLogFiles& files, std::string_view log, const nlohmann::json& truth);

}  // namespace hydroscope
