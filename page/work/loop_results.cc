#include "page/work/loop_results.h"

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/constants.h"
#include "models/closed_loop.h"
#include "workbench/frequency_response/loop_change.h"
#include "workbench/frequency_response/loop_output.h"

namespace hydroscope {
namespace {

constexpr std::size_t kMostPoints = 400;
const double kDecibelsOfE = 20 / std::numbers::ln10;

std::string FileName(const std::string& path) { return std::filesystem::path(path).filename(); }

/// Gain and phase of a model at the points.
void AddCurve(const LoopLog& measured, const std::vector<const FrequencyPoint*>& points,
              const std::vector<double>& parameters, const std::string& of, nlohmann::json& response) {
  for (const FrequencyPoint* p : points) {
    const double gain = std::abs(measured.model.Response(p->frequency, parameters));
    response[of + "_gain"].push_back(kDecibelsOfE * std::log(gain));
    response[of + "_phase"].push_back(PhaseBeside(measured.model, parameters, p->frequency, *p) * kDegrees);
  }
}

nlohmann::json ResponseJson(const LoopLog& measured, const Result<LoopState>& before) {
  const std::vector<const FrequencyPoint*> points = UsedPoints(measured.response, kMostPoints);
  nlohmann::json json = {{"f_hz", nlohmann::json::array()}};
  for (const FrequencyPoint* p : points) {
    json["f_hz"].push_back(p->frequency);
    json["gain"].push_back(kDecibelsOfE * std::log(p->gain()));
    json["gain_half"].push_back(kDecibelsOfE * kNormal95 * p->GainStd() / p->gain());
    json["phase"].push_back(p->phase * kDegrees);
    json["phase_half"].push_back(kNormal95 * p->PhaseStd() * kDegrees);
  }
  if (measured.response.fit) AddCurve(measured, points, measured.response.fit->parameters, "model", json);
  if (before) AddCurve(measured, points, before->parameters, "before", json);
  return json;
}

}  // namespace

Result<nlohmann::json> WorkOutLoop(WorkRequest::Kind kind, const WorkInput& input) {
  if (kind == WorkRequest::Kind::kExplain) {
    auto changed = TRY(ExplainLoopLog(input.Newest(), input.hold_out, input.machine_file));
    changed.since = FileName(changed.since);
    changed.after.name = FileName(changed.after.name);
    nlohmann::json json = LoopChangeJson(changed);
    json["text"] = LoopChangeText(changed);
    return json;
  }
  const auto machine = TRY(LoadMachine(input.machine_file));
  auto measured = TRY(MeasureLoopLog(input.Newest(), machine));
  measured.name = FileName(measured.name);
  nlohmann::json json = LoopJson(measured, machine);
  json.erase("points");
  json["response"] = ResponseJson(measured, LoopStateBefore(input.hold_out, machine));
  json["text"] = LoopText(measured, machine);
  return json;
}

}  // namespace hydroscope
