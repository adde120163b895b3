#include "core/effect_units.h"

#include "core/constants.h"

namespace hydroscope {

DisplayUnit DisplayUnitOfEffect(std::string_view si) {
  constexpr double kBar = 1e-5;
  if (si == "1") return {1.0, 0, "-"};
  if (si == "s") return {1e3, 0, "ms"};
  if (si == "1/K") return {1e2, 0, "%/K"};
  if (si == "1/s") return {6e3, 0, "%/min"};
  if (si == "Pa/s") return {60 * kBar, 0, "bar/min"};
  if (si == "Pa/m") return {kBar, 0, "bar/m"};
  if (si == "Pa2") return {kBar * kBar, 0, "bar^2"};
  if (si == "s2") return {1e6, 0, "ms^2"};
  if (si == "Pa s/m3") return {kBar / kLitresPerMinute, 0, "bar per l/min"};
  if (si == "Pa s2/m6") return {kBar / (kLitresPerMinute * kLitresPerMinute), 0, "bar per (l/min)^2"};
  const DisplayUnit shown = DisplayUnitFor(si);
  return {shown.factor, 0, shown.name};
}

EffectUnit EffectUnitFor(std::string_view si) {
  const DisplayUnit shown = DisplayUnitOfEffect(si);
  return {shown.factor, std::string(shown.name)};
}

}  // namespace hydroscope
