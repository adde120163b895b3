#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "estimation/frequency_response/frequency_response.h"
#include "models/machine.h"
#include "workbench/frequency_response/frf_record.h"

namespace hydroscope {

/// Result of `frf` for people: table of points, model with 95 % intervals and units, warnings, a hint if the
/// amplitude was too large.
std::string FrfText(const FrequencyResponse& response, const FrfRecord& log, const Machine& machine,
                    const std::string& log_name);

/// Result of `frf` for scripts, keys as documented in docs/frequency_response.md.
nlohmann::json FrfJson(const FrequencyResponse& response, const FrfRecord& log, const Machine& machine);

/// Bode plot as a self-contained SVG: points with 95 % bars, model curve; follows the reader's light or dark theme.
std::string FrfBodePlot(const FrequencyResponse& response, const std::string& title);

}  // namespace hydroscope
