#include "diagnosis/drift/valve_check_monitor.h"

#include <array>
#include <cmath>

#include "diagnosis/drift/drift_thresholds.h"

namespace hydroscope::drift {
namespace {

struct Figure {
  const char* name;
  const char* unit;
  ValueWithStd ValveCheck::*value;
};
constexpr auto& kNames = ValveCheckMonitor::kFigureNames;
constexpr std::array<Figure, kNames.size()> kFigureList = {{{kNames[0], "Hz", &ValveCheck::natural_frequency},
                                                            {kNames[1], "1", &ValveCheck::damping},
                                                            {kNames[2], "s", &ValveCheck::dead_time}}};
constexpr std::uint32_t kMostPoints = 10'000;

}  // namespace

void ValveCheckMonitor::Learn() {
  for (const auto& points : points_)
    curves_.push_back(TemperatureModel::Fit(points, CurveFamily::kSmooth).value());
}

DriftFinding ValveCheckMonitor::Add(const ValveCheck& check, std::int64_t sequence) {
  DriftFinding finding;
  finding.found = finding.last = sequence;
  finding.oil_temperature = check.oil_temperature;
  for (const Figure& figure : kFigureList)
    if (!std::isfinite((check.*figure.value).value) || !((check.*figure.value).std > 0)) return finding;
  if (!commissioned()) {
    for (int f = 0; f < kFigures; ++f) {
      const ValueWithStd& v = check.*kFigureList[f].value;
      points_[f].push_back({check.oil_temperature, v.value, v.std});
    }
    last_good_ = sequence;
    if (static_cast<int>(points_[0].size()) == kCommissioning) Learn();
    return finding;
  }
  std::map<std::string, int> movements;
  for (int f = 0; f < kFigures; ++f) {
    const Figure& figure = kFigureList[f];
    const WatchSpec* watch = rules_->Find(figure.name);
    if (watch == nullptr) continue;
    const ValueWithStd& v = check.*figure.value;
    const auto expected = curves_[f].At(check.oil_temperature);
    const DriftSize size = watch->Sizes(expected.value);
    const double near = kDriftThresholds.valve_check_share * size.smallest;
    const double std = std::hypot(v.std, expected.std), deviation = v.value - expected.value;
    if (std::abs(deviation) <= near + kDriftThresholds.valve_check * std) continue;
    movements[figure.name] = deviation > 0 ? 1 : -1;
    const bool alarm = std::abs(deviation) >= size.alarm;
    finding.parts.push_back({figure.name, figure.unit, deviation, std, expected.value, near, alarm});
    finding.alarm = finding.alarm || alarm;
  }
  if (movements.empty()) {
    last_good_ = sequence;
    return finding;
  }
  finding.state = FindingState::kNamed;
  finding.since = {last_good_, last_good_, sequence - 1};
  finding.name =
      Tell("Change of the valve that no rule names", "Änderung des Ventils, die keine Regel benennt");
  finding.guidance = Tell("Repeat the valve check; compare its plot with the one of commissioning.",
                          "Die Ventilprüfung wiederholen; ihr Bild mit dem der Inbetriebnahme vergleichen.");
  if (const Rule* rule = rules_->Match(movements)) {
    finding.rule = rule->id;
    finding.name = rule->name;
    finding.guidance = rule->guidance;
    finding.severity = rule->severity;
  }
  return finding;
}

void ValveCheckMonitor::Save(ByteWriter& out) const {
  out.Put(last_good_);
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(points_[0].size()));
  for (const auto& points : points_)
    for (const TemperaturePoint& p : points) out.Put(p);
}

bool ValveCheckMonitor::Restore(ByteReader& in) {
  last_good_ = in.Get<std::int64_t>();
  const auto count = in.Get<std::uint32_t>();
  if (count > kMostPoints) return false;
  for (auto& points : points_) {
    points.clear();
    for (std::uint32_t k = 0; k < count && in.ok(); ++k) points.push_back(in.Get<TemperaturePoint>());
  }
  curves_.clear();
  if (in.ok() && count >= kCommissioning) Learn();
  return in.ok();
}

}  // namespace hydroscope::drift
