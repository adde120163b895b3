#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/result.h"
#include "estimation/frequency_response/frequency_response.h"

namespace hydroscope {

/// Of {"method": "auto" | "sine" | "welch", "segment", "min_coherence", "from", "to", "settle"}, as the options of `frf`; all may be
/// absent. Errors name the key, what it holds, and what was expected.
Result<FrequencyResponseOptions> ParseResponseOptions(const nlohmann::json& object);

}  // namespace hydroscope
