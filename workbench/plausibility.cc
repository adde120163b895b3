#include "workbench/plausibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/units.h"

namespace hydroscope {
namespace {

/// What a quantity on a hydraulic machine looks like; `measure` of a signal lies between `low` and `high`,
/// SI.
struct Expectation {
  const char* si;
  enum { kLargest, kTravel, kMean } measure;
  double low, high;  ///< SI
  const char* text;  ///< of what is expected
  std::vector<const char*> units;
};

const std::vector<Expectation>& Expectations() {
  static const std::vector<Expectation> kAll = {
      {"Pa",
       Expectation::kLargest,
       5e5,
       1e8,
       "pressures of a hydraulic machine reach 5 to 1000 bar",
       {"bar", "Pa", "MPa", "kPa", "psi", "mbar"}},
      {"m", Expectation::kTravel, 1e-3, 10, "strokes are 1 mm to 10 m long", {"mm", "m", "cm", "um"}},
      {"K", Expectation::kMean, 253, 403, "oil is between -20 and 130 °C", {"degC", "K"}},
      {"V", Expectation::kLargest, 0.1, 50, "valve commands reach 0.1 to 50 V", {"V", "mV"}}};
  return kAll;
}

const Expectation kSpool = {
    "1", Expectation::kLargest, 0.03, 1.5, "a spool position is between -1 and 1", {"1", "%"}};

double Measure(const Expectation& expected, double min, double max, double mean) {
  switch (expected.measure) {
    case Expectation::kLargest:
      return std::max(std::abs(min), std::abs(max));
    case Expectation::kTravel:
      return max - min;
    case Expectation::kMean:
      return mean;
  }
  return mean;
}

const Expectation* ExpectationFor(const SignalSpec& spec, const Unit& unit) {
  if (spec.name == "y_v") return &kSpool;
  for (const Expectation& e : Expectations())
    if (e.si == unit.si) return &e;
  return nullptr;
}

/// The unit in which the column's numbers would look right, if any.
std::optional<std::string> BetterUnit(const Expectation& expected, const CheckedSignal& signal,
                                      const Unit& unit) {
  const auto raw = [&](double si) { return (si - unit.offset) / unit.scale; };
  for (const char* name : expected.units) {
    const auto other = FindUnit(name);
    if (!other || name == signal.spec.unit) continue;
    const auto si = [&](double x) { return raw(x) * other->scale + other->offset; };
    const double measure =
        Measure(expected, si(signal.range.min), si(signal.range.max), si(signal.range.mean()));
    if (measure >= expected.low && measure <= expected.high) return name;
  }
  return std::nullopt;
}

void JudgeUnit(const CheckedSignal& signal, std::vector<std::string>& hints) {
  const auto unit = FindUnit(signal.spec.unit);
  if (!unit || !signal.range.seen()) return;
  const Expectation* expected = ExpectationFor(signal.spec, *unit);
  if (expected == nullptr) return;
  const double measure = Measure(*expected, signal.range.min, signal.range.max, signal.range.mean());
  if (measure >= expected->low && measure <= expected->high) return;
  const auto raw = [&](double si) { return (si - unit->offset) / unit->scale; };
  std::string text =
      fmt::format("{} (column {}): the numbers go from {:.4g} to {:.4g}, unit \"{}\" in the machine file; {}",
                  signal.spec.name, signal.spec.column, raw(signal.range.min), raw(signal.range.max),
                  signal.spec.unit, expected->text);
  if (const auto better = BetterUnit(*expected, signal, *unit))
    text += fmt::format(". They look like {}: set unit = \"{}\"", *better, *better);
  hints.push_back(text);
}

void JudgeRest(const CheckedSignal& signal, std::vector<std::string>& hints) {
  if (signal.range.readings < 100 || signal.range.max > signal.range.min) return;
  hints.push_back(
      fmt::format("{} (column {}): one and the same reading in the whole log; is the sensor connected?",
                  signal.spec.name, signal.spec.column));
}

/// Without strokes, a signal that is hardly ever good explains more than the gate.
void JudgeGood(const CheckResult& check, const CheckedSignal& signal, std::vector<std::string>& hints) {
  if (check.driving.strokes > 0 || !signal.spec.required || check.time.rows == 0) return;
  if (static_cast<double>(signal.range.good) > 0.01 * static_cast<double>(check.time.rows)) return;
  hints.push_back(
      fmt::format("{} (column {}): {} of {} readings are good, and no stroke can be used without it",
                  signal.spec.name, signal.spec.column, signal.range.good, check.time.rows));
}

void JudgeGate(const CheckResult& check, std::vector<std::string>& hints) {
  if (check.driving.strokes > 0) return;
  for (const ConditionSurvey& c : check.conditions) {
    if (c.share >= 0.01) continue;
    std::string text =
        fmt::format("gate: the condition {} holds in {:.1f} % of the log", c.condition, 100 * c.share);
    if (c.share_mirrored > 0.05)
      text += fmt::format(
          "; with the sign of the signal reversed it would hold in {:.0f} %: set scale = -1 for that signal, "
          "or "
          "reverse the condition",
          100 * c.share_mirrored);
    else
      text += "; check its limits in [gate] against the range of the signal above";
    hints.push_back(text);
  }
}

/// At one speed a leak and the valve's own flow have the same shape, and the intervals do not show it.
void JudgeSpeeds(const Driving& d, std::vector<std::string>& hints) {
  constexpr double kLittleVariation = 1.3;
  if (d.strokes < 2 || !(d.speed_min > 0) || d.speed_max > kLittleVariation * d.speed_min) return;
  hints.push_back(fmt::format(
      "all strokes ran at {:.0f} to {:.0f} mm/s: at one speed a leak looks like more or less valve flow. The "
      "intervals hold only if the model lacks nothing; vary ram speed between strokes to find out",
      d.speed_min * 1e3, d.speed_max * 1e3));
}

}  // namespace

std::vector<std::string> PlausibilityHints(const CheckResult& check) {
  std::vector<std::string> hints;
  for (const CheckedSignal& signal : check.signals) {
    if (!signal.present) continue;
    if (check.driving.words.hydraulic) JudgeUnit(signal, hints);
    JudgeRest(signal, hints);
    JudgeGood(check, signal, hints);
  }
  JudgeGate(check, hints);
  JudgeSpeeds(check.driving, hints);
  return hints;
}

}  // namespace hydroscope
