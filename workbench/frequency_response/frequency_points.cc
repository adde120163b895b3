#include "workbench/frequency_response/frequency_points.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/constants.h"

namespace hydroscope {

nlohmann::json FrequencyPointJson(const FrequencyPoint& point) {
  nlohmann::json json = {{"f_hz", point.frequency},
                         {"gain", point.gain()},
                         {"phase_deg", point.phase * kDegrees},
                         {"gain_std", point.GainStd()},
                         {"phase_std_deg", point.PhaseStd() * kDegrees},
                         {"coherence", point.coherence},
                         {"amplitude", point.amplitude},
                         {"output_amplitude", point.output_amplitude},
                         {"periods", point.periods}};
  if (point.dropped > 0) json["transient_s"] = point.dropped;
  if (!std::isnan(point.output_distortion)) {
    json["distortion"] = point.output_distortion;
    json["input_distortion"] = point.input_distortion;
  }
  return json;
}

std::vector<const FrequencyPoint*> ThinnedPoints(std::vector<const FrequencyPoint*> points,
                                                 std::size_t most) {
  if (points.size() <= most) return points;
  std::vector<const FrequencyPoint*> chosen;
  const double first = std::log(points.front()->frequency), last = std::log(points.back()->frequency);
  double next = first;
  for (const FrequencyPoint* p : points) {
    if (std::log(p->frequency) < next - 1e-9) continue;
    chosen.push_back(p);
    while (next <= std::log(p->frequency) + 1e-9) next += (last - first) / static_cast<double>(most);
  }
  if (chosen.back() != points.back()) chosen.push_back(points.back());
  return chosen;
}

nlohmann::json LeftOutPointsJson(const std::vector<FrequencyPoint>& points) {
  nlohmann::json json = nlohmann::json::array();
  for (const FrequencyPoint& p : points)
    if (p.reason != PointReason::kUsed)
      json.push_back(
          {{"f_hz", p.frequency}, {"reason", PointReasonName(p.reason)}, {"coherence", p.coherence}});
  return json;
}

}  // namespace hydroscope
