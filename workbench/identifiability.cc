#include "workbench/identifiability.h"

#include <fmt/format.h>

#include <cmath>

#include "core/constants.h"

namespace hydroscope {
namespace {

constexpr int kFewStrokes = 10;
constexpr double kMostStrokesAdvised = 2000;

double Goal(const Estimate& estimate) { return estimate.unit == "1" ? 0.01 : 0.10; }

/// A condition of the strokes that somebody can vary and nobody did; nullptr: none.
const ConditionRange* Constant(const Driving& d) {
  for (const ConditionRange& range : d.ranges)
    if (!range.condition.vary.empty() && !range.varies()) return &range;
  return nullptr;
}

/// What would excite the parameters better than this log does.
std::string DriveBetter(const Driving& d) {
  if (d.strokes == 0) return "first get strokes inside the gate: see the table of signals and the gate above";
  if (d.strokes < kFewStrokes)
    return fmt::format("record at least {} strokes, this log has {}", kFewStrokes, d.strokes);
  if (const ConditionRange* same = Constant(d))
    return fmt::format("vary {} between strokes: their {} was {}", same->condition.vary,
                       same->condition.title, same->Text());
  return fmt::format("vary {} more, also within a stroke", d.words.vary);
}

/// Intervals shrink with the square root of the number of strokes.
std::string MoreStrokes(const Estimate& estimate, const Driving& d) {
  const double ratio = HalfWidth(estimate) / Goal(estimate);
  const double strokes = std::ceil(d.strokes * ratio * ratio / 10) * 10;
  if (!(strokes < kMostStrokesAdvised)) return DriveBetter(d);
  if (d.of_one_log) return fmt::format("record {:.0f} times as long", std::ceil(ratio * ratio));
  return fmt::format("record at least {:.0f} strokes like these {}", strokes, d.strokes);
}

void Explain(CheckedParameter& p, const Driving& d) {
  const Estimate& e = p.estimate;
  if (d.strokes < 2 && e.reason != EstimateReason::kOutsidePhysics) {
    p.reason = "one stroke alone gives no interval";
    p.advice = DriveBetter(d);
  } else if (e.reason == EstimateReason::kOutsidePhysics) {
    p.reason = ReasonText(e.reason);
    p.advice = "check units, signs and geometry in the machine file";
    if (d.strokes < kFewStrokes) p.advice += ", and " + DriveBetter(d);
  } else if (p.verdict == Identifiability::kNot) {
    p.reason = e.reason == EstimateReason::kUpdated ? "the interval is wider than the value is worth"
                                                    : ReasonText(e.reason);
    p.advice = DriveBetter(d);
  } else if (p.verdict == Identifiability::kWeak) {
    p.reason = "the interval is wide";
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
      p.verdict = HalfWidth(estimate) <= Goal(estimate) ? Identifiability::kGood : Identifiability::kWeak;
    Explain(p, driving);
    out.push_back(std::move(p));
  }
  return out;
}

std::vector<CheckedParameter> ParametersWithoutFit(const ModelStructure& model, const std::string& why,
                                                   const Driving& driving) {
  std::vector<CheckedParameter> out;
  for (const DerivedParameter& derived : model.derive(Eigen::VectorXd::Ones(model.base_count))) {
    CheckedParameter p;
    p.estimate.parameter = derived.name;
    p.estimate.unit = derived.unit;
    p.estimate.value = p.estimate.std = std::nan("");
    p.estimate.reason = driving.strokes == 0 ? EstimateReason::kNoStroke : EstimateReason::kConfounded;
    p.reason = driving.strokes == 0 ? ReasonText(EstimateReason::kNoStroke) : why;
    p.advice = DriveBetter(driving);
    out.push_back(std::move(p));
  }
  return out;
}

}  // namespace hydroscope
