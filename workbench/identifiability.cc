#include "workbench/identifiability.h"

#include <cmath>

#include "core/constants.h"
#include "core/records/reason_told.h"

namespace hydroscope {
namespace {

constexpr int kFewStrokes = 10;
constexpr double kMostStrokesAdvised = 2000;

/// Half width of the interval of a parameter that is known well: of shares, and relative of all others.
constexpr double kGoalOfShares = 0.01, kGoal = 0.10;

/// Half width of the interval over that goal. Of a model with states a number without a unit is no share: it may be any size.
double OverGoal(const Estimate& estimate, const Driving& d) {
  const double half = kNormal95 * estimate.std;
  return estimate.unit == "1" && !d.of_one_log ? half / kGoalOfShares
                                               : half / std::abs(estimate.value) / kGoal;
}

/// A condition of the strokes that somebody can vary and nobody did; nullptr: none.
const ConditionRange* Constant(const Driving& d) {
  for (const ConditionRange& range : d.ranges)
    if (!range.condition.vary.empty() && !range.varies()) return &range;
  return nullptr;
}

/// What would excite the parameters better than this log does.
Told DriveBetter(const Driving& d) {
  if (d.strokes == 0)
    return Tell("first get strokes inside the gate: see the table of signals and the gate above",
                "zuerst Hübe in das Gate bringen: siehe die Tabelle der Signale und das Gate oben");
  if (d.strokes < kFewStrokes)
    return Tell("record at least {} strokes, this log has {}",
                "mindestens {} Hübe aufzeichnen, diese Aufzeichnung hat {}", kFewStrokes, d.strokes);
  if (const ConditionRange* same = Constant(d))
    return Tell("vary {} between strokes: their {} was {}", "zwischen den Hüben variieren: {} ({}: {})",
                same->condition.vary, same->condition.title, same->Text());
  return Tell("vary {} more, also within a stroke", "mehr variieren, auch innerhalb eines Hubes: {}",
              d.words.vary);
}

/// Intervals shrink with the square root of the number of strokes.
Told MoreStrokes(const Estimate& estimate, const Driving& d) {
  const double ratio = OverGoal(estimate, d);
  const double strokes = std::ceil(d.strokes * ratio * ratio / 10) * 10;
  if (!(strokes < kMostStrokesAdvised)) return DriveBetter(d);
  if (d.of_one_log)
    return Tell("record {:.0f} times as long", "{:.0f}-mal so lang aufzeichnen", std::ceil(ratio * ratio));
  return Tell("record at least {:.0f} strokes like these {}",
              "mindestens {:.0f} Hübe wie diese {} aufzeichnen", strokes, d.strokes);
}

void GiveReason(CheckedParameter& p, const Driving& d) {
  const Estimate& e = p.estimate;
  if (d.strokes < 2 && e.reason != EstimateReason::kOutsidePhysics) {
    p.reason = Tell("one stroke alone gives no interval", "ein Hub allein gibt kein Intervall");
    p.advice = DriveBetter(d);
  } else if (e.reason == EstimateReason::kOutsidePhysics) {
    p.reason = ReasonTold(e.reason);
    p.advice = Tell("check units, signs and geometry in the machine file",
                    "Einheiten, Vorzeichen und Geometrie in der Maschinendatei prüfen");
    if (d.strokes < kFewStrokes) p.advice = Tell("{}, and {}", "{}, und {}", p.advice, DriveBetter(d));
  } else if (p.verdict == Identifiability::kNot) {
    p.reason = e.reason == EstimateReason::kUpdated ? Tell("the interval is wider than the value is worth",
                                                           "das Intervall ist breiter, als der Wert groß ist")
                                                    : ReasonTold(e.reason);
    p.advice = DriveBetter(d);
  } else if (p.verdict == Identifiability::kWeak) {
    p.reason = Tell("the interval is wide", "das Intervall ist breit");
    p.advice = Constant(d) == nullptr ? MoreStrokes(e, d) : DriveBetter(d);
  }
}

}  // namespace

const char* IdentifiabilityName(Identifiability verdict) {
  switch (verdict) {
    case Identifiability::kGood:
      return "good";
    case Identifiability::kWeak:
      return "weak";
    case Identifiability::kNot:
      return "not";
  }
  return "";
}

double HalfWidth(const Estimate& estimate) {
  const double half = kNormal95 * estimate.std;
  return estimate.unit == "1" ? half : half / std::abs(estimate.value);
}

std::vector<CheckedParameter> JudgeParameters(std::span<const Estimate> estimates, const Driving& driving) {
  std::vector<CheckedParameter> out;
  for (const Estimate& estimate : estimates) {
    CheckedParameter p;
    p.estimate = estimate;
    if (estimate.reason != EstimateReason::kUpdated || driving.strokes < 2)
      p.verdict = Identifiability::kNot;
    else
      p.verdict = OverGoal(estimate, driving) <= 1 ? Identifiability::kGood : Identifiability::kWeak;
    GiveReason(p, driving);
    out.push_back(std::move(p));
  }
  return out;
}

std::vector<CheckedParameter> ParametersWithoutFit(const ModelStructure& model, const Told& why,
                                                   const Driving& driving, const Told& advice) {
  std::vector<CheckedParameter> out;
  for (const DerivedParameter& derived : model.derive(Eigen::VectorXd::Ones(model.base_count))) {
    CheckedParameter p;
    p.estimate.parameter = derived.name;
    p.estimate.unit = derived.unit;
    p.estimate.value = p.estimate.std = std::nan("");
    p.estimate.reason = driving.strokes == 0 ? EstimateReason::kNoStroke : EstimateReason::kConfounded;
    p.reason = driving.strokes == 0 ? ReasonTold(EstimateReason::kNoStroke) : why;
    p.advice = advice.empty() ? DriveBetter(driving) : advice;
    out.push_back(std::move(p));
  }
  return out;
}

}  // namespace hydroscope
