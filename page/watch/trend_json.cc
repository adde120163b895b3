#include "page/watch/trend_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/constants.h"
#include "core/json_value.h"

namespace hydroscope {
namespace {

constexpr int kPointsOfCurve = 60;
constexpr double kBeyond = 3;  ///< K that the curve is drawn beyond what was learned
constexpr std::size_t kMostMarksShown = 400;

nlohmann::json CurveJson(const drift::TemperatureModel& curve) {
  nlohmann::json json = {
      {"form", curve.FormName()}, {"low_K", JsonNumber(curve.low())}, {"high_K", JsonNumber(curve.high())}};
  for (const char* list : {"oil_temperature_K", "value", "std"}) json[list] = nlohmann::json::array();
  for (int k = 0; k <= kPointsOfCurve; ++k) {
    const double t = curve.low() - kBeyond + (curve.high() - curve.low() + 2 * kBeyond) * k / kPointsOfCurve;
    const auto p = curve.At(t);
    json["oil_temperature_K"].push_back(JsonNumber(t));
    json["value"].push_back(JsonNumber(p.value));
    json["std"].push_back(JsonNumber(p.std));
  }
  return json;
}

/// Healthy value at each bin's oil, and what the oil accounts for against its middle temperature.
void AddHealthy(const drift::TemperatureModel& curve, const TrendPicture& picture, nlohmann::json& json) {
  const double middle = (curve.low() + curve.high()) / 2;
  const double at_middle = curve.At(middle).value;
  nlohmann::json value = nlohmann::json::array(), std = nlohmann::json::array(),
                 by_oil = nlohmann::json::array();
  for (const TrendBin& bin : picture.bins) {
    const auto p = curve.At(bin.oil_temperature);
    value.push_back(JsonNumber(p.value));
    std.push_back(JsonNumber(p.std));
    by_oil.push_back(JsonNumber(p.value - at_middle));
  }
  json["healthy"] = {
      {"value", std::move(value)},      {"std", std::move(std)},
      {"by_oil", std::move(by_oil)},    {"compensates", curve.tells_slope()},
      {"middle_K", JsonNumber(middle)}, {"curve", curve.tells_slope() ? CurveJson(curve) : nlohmann::json()}};
}

nlohmann::json MarksJson(const std::vector<TrendMark>& marks, std::int64_t first, std::int64_t end) {
  nlohmann::json list = nlohmann::json::array();
  for (auto mark = marks.rbegin(); mark != marks.rend() && list.size() < kMostMarksShown; ++mark)
    if (mark->stroke >= first && mark->stroke < end)
      list.push_back({{"kind", mark->kind},
                      {"stroke", mark->stroke},
                      {"name", mark->name.english},
                      {"text", mark->text.english},
                      {"german", {{"name", mark->name.german}, {"text", mark->text.german}}}});
  return list;
}

}  // namespace

nlohmann::json TrendJson(const TrendQuestion& question, const TrendPicture& picture,
                         const WatchedState::MachineState& machine) {
  nlohmann::json json = {{"machine", question.machine}, {"parameter", question.parameter},
                         {"first", question.first},     {"end", question.end},
                         {"strokes", machine.end},      {"width", picture.width},
                         {"exact", picture.exact},      {"dated", machine.dated},
                         {"healthy", nullptr},          {"limits", nlohmann::json::array()}};
  nlohmann::json bins;
  for (const char* list :
       {"first", "last", "run", "begin_s", "end_s", "low", "high", "mean", "std", "oil_temperature_K"})
    bins[list] = nlohmann::json::array();
  for (const TrendBin& bin : picture.bins) {
    bins["first"].push_back(bin.first);
    bins["last"].push_back(bin.last);
    bins["run"].push_back(bin.run);
    bins["begin_s"].push_back(JsonNumber(bin.begin));
    bins["end_s"].push_back(JsonNumber(bin.end));
    bins["low"].push_back(JsonNumber(bin.low));
    bins["high"].push_back(JsonNumber(bin.high));
    bins["mean"].push_back(JsonNumber(bin.mean));
    bins["std"].push_back(JsonNumber(bin.std));
    bins["oil_temperature_K"].push_back(JsonNumber(bin.oil_temperature));
  }
  json["bins"] = std::move(bins);
  json["marks"] = MarksJson(machine.marks, question.first, question.end);
  const auto known = machine.parameters.find(question.parameter);
  if (known == machine.parameters.end()) return json;
  for (const auto& [name, value] : known->second.limits)
    json["limits"].push_back({{"name", name}, {"value", value}});
  if (known->second.healthy) AddHealthy(*known->second.healthy, picture, json);
  return json;
}

}  // namespace hydroscope
