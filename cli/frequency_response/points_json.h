#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "estimation/frequency_response/frequency_response.h"

namespace hydroscope {

/// A point of a response: frequency in Hz, gain, phase in degrees, their standard deviations, coherence, what it rests on.
nlohmann::json FrequencyPointJson(const FrequencyPoint& point);

/// The points that are not used, each with its reason.
nlohmann::json LeftOutPointsJson(const std::vector<FrequencyPoint>& points);

}  // namespace hydroscope
