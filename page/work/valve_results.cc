#include "page/work/valve_results.h"

#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "core/constants.h"
#include "core/told_error.h"
#include "workbench/frequency_response/frequency_points.h"
#include "workbench/frequency_response/valve_output.h"

namespace hydroscope {
namespace {

constexpr std::size_t kMostValvePoints = 400;
constexpr int kCurvePoints = 200;

/// Frequencies of a curve through the points, at equal steps of its logarithm.
std::vector<double> CurveFrequencies(const std::vector<const FrequencyPoint*>& points) {
  std::vector<double> frequencies;
  const double lowest = points.front()->frequency, highest = points.back()->frequency;
  for (int i = 0; i <= kCurvePoints; ++i)
    frequencies.push_back(lowest * std::pow(highest / lowest, static_cast<double>(i) / kCurvePoints));
  return frequencies;
}

nlohmann::json CurveJson(const FrequencyResponse& response, const std::vector<double>& frequencies) {
  if (!response.model) return nullptr;
  nlohmann::json curve = {{"f_hz", frequencies}};
  for (const double f : frequencies) {
    curve["gain"].push_back(20 * std::log10(std::abs(response.model->Response(f))));
    curve["phase"].push_back(response.model->Phase(f) * kDegrees);
  }
  return curve;
}

/// As `frf --json`, with as many points as a picture shows.
nlohmann::json MeasuredJson(const ValveLog& measured, const Machine& machine) {
  nlohmann::json json = ValveJson(measured, machine);
  std::map<std::string, int> left_out;
  for (const FrequencyPoint& p : measured.response.points)
    if (p.reason != PointReason::kUsed) ++left_out[PointReasonName(p.reason)];
  json["left_out"] = left_out;
  json["points"] = nlohmann::json::array();
  for (const FrequencyPoint* p : ThinnedPoints(measured.Used(), kMostValvePoints)) {
    nlohmann::json point = FrequencyPointJson(*p);
    if (const auto& model = measured.response.model) {
      point["model_gain"] = std::abs(model->Response(p->frequency));
      point["model_phase_deg"] = model->Phase(p->frequency) * kDegrees;
    }
    json["points"].push_back(std::move(point));
  }
  json["log"] = measured.name;
  return json;
}

Result<ValveLog> MeasureNamed(const std::string& log, const Machine& machine,
                              const FrequencyResponseOptions& options) {
  auto measured = MeasureValveLog(log, machine, options);
  if (measured) measured->name = std::filesystem::path(log).filename();
  return measured;
}

}  // namespace

Result<nlohmann::json> WorkOutValve(const WorkInput& input, const FrequencyResponseOptions& options) {
  const auto machine = TRY(LoadMachine(input.machine_file));
  const auto measured = TRY(MeasureNamed(input.Newest(), machine, options));
  const std::vector<double> frequencies = CurveFrequencies(measured.Used());
  nlohmann::json json = MeasuredJson(measured, machine);
  json["text"] = ValveText(measured, machine);
  json["options"] = {{"method", MethodName(options.method)},
                     {"segment", options.segment_length},
                     {"min_coherence", options.min_coherence},
                     {"from", options.lowest},
                     {"to", options.highest},
                     {"settle", options.settle_time}};
  json["curve"] = CurveJson(measured.response, frequencies);
  json["before"] = nullptr;
  if (input.hold_out.empty()) return json;
  const auto before = MeasureNamed(input.hold_out, machine, options);
  if (!before) {
    const Told why = ToldOf(before.error());
    json["warnings"].push_back(why.english);
    json["german"]["warnings"].push_back(why.german);
    return json;
  }
  json["before"] = MeasuredJson(*before, machine);
  json["before"].erase("points");
  json["before"]["curve"] = CurveJson(before->response, frequencies);
  return json;
}

}  // namespace hydroscope
