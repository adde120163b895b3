#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "estimation/frequency_response/frequency_response.h"

namespace hydroscope {

/// A point of a response: frequency in Hz, gain, phase in degrees, their standard deviations, coherence, what it rests on.
nlohmann::json FrequencyPointJson(const FrequencyPoint& point);

/// Of many points the one nearest to each of `most` equal steps of log frequency.
std::vector<const FrequencyPoint*> ThinnedPoints(std::vector<const FrequencyPoint*> points, std::size_t most);

/// The points that are not used, each with its reason.
nlohmann::json LeftOutPointsJson(const std::vector<FrequencyPoint>& points);

}  // namespace hydroscope
