#include "workbench/explain/drift_text.h"

#include <algorithm>
#include <cmath>

#include "core/contains.h"
#include "core/effect_units.h"
#include "core/unit_told.h"

namespace hydroscope {
namespace {

/// s from the first to the last sample explained.
double SecondsOf(const ExplainResult& result) {
  double first = INFINITY, last = -INFINITY;
  for (const StrokeStretches& stroke : result.log.stretches)
    for (const Stretch& s : stroke) {
      first = std::min(first, s.begin);
      last = std::max(last, s.begin + s.samples * s.period);
    }
  return std::max(0.0, last - first);
}

/// Whether something else may as well have been found in its place.
bool HasRivals(const ExplainResult& result, const std::string& id) {
  return std::ranges::any_of(result.explanation.groups, [&](const std::vector<std::string>& group) {
    return group.size() > 1 && Contains(group, id);
  });
}

}  // namespace

Told DriftText(const ExplainResult& result, const EffectEstimate& estimate) {
  const Effect& effect = result.effect(estimate.choice.effect);
  const double seconds = SecondsOf(result), of_rate = estimate.size * seconds;
  const double change =
      effect.drifting.english == "K" ? of_rate / std::max(1e-3, 1 - of_rate) : of_rate;  // 1/K falls
  if (effect.drifting.empty() || seconds <= 0) return {};
  const Told moved = change < 0 ? Tell("fell", "fiel") : Tell("rose", "stieg");
  const Told given =
      HasRivals(result, effect.id) ? Tell("if it is {}, ", "wenn es {} ist: ", effect.id) : Told{};
  if (!effect.drifts_by.empty()) {
    const EffectUnit unit = EffectUnitFor(effect.drifts_by);
    return Tell("{}{} {} by {:.2g}{} during this log ({:.0f} s)",
                "{}{} {} in dieser Aufzeichnung um {:.2g}{} ({:.0f} s)", given, effect.drifting, moved,
                std::abs(change) * unit.factor, unit.name == "-" ? Told{} : UnitTold(" " + unit.name),
                seconds);
  }
  return Tell("{}{} {} by {:.2g} % during this log ({:.0f} s)",
              "{}{} {} in dieser Aufzeichnung um {:.2g} % ({:.0f} s)", given, effect.drifting, moved,
              100 * std::abs(change), seconds);
}

}  // namespace hydroscope
