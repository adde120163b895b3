#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "estimation/frequency_response/frequency_response.h"
#include "page/work/work_results.h"

namespace hydroscope {

/// Work on a log of a valve: as `frf --json` with some 400 of its `points` (and of the model `model_gain` and `model_phase_deg`
/// there), how many are `left_out` for each reason, `log`, `options`, `text`, what the command prints, `curve` (`f_hz`, and of the model `gain` in dB and `phase` in degrees) or null, and `before`: the same of
/// the log held out, its curve at the same frequencies, without points and text; null: none is, or it cannot be measured, which
/// `warnings` tell.
Result<nlohmann::json> WorkOutValve(const WorkInput& input, const FrequencyResponseOptions& options);

}  // namespace hydroscope
