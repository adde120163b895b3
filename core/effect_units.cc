#include "core/effect_units.h"

#include "core/constants.h"
#include "core/units.h"

namespace hydroscope {

EffectUnit EffectUnitFor(std::string_view si) {
  constexpr double kBar = 1e-5;
  if (si == "1") return {1.0, "-"};
  if (si == "s") return {1e3, "ms"};
  if (si == "1/K") return {1e2, "%/K"};
  if (si == "1/s") return {6e3, "%/min"};
  if (si == "Pa/s") return {60 * kBar, "bar/min"};
  if (si == "Pa/m") return {kBar, "bar/m"};
  if (si == "Pa2") return {kBar * kBar, "bar^2"};
  if (si == "s2") return {1e6, "ms^2"};
  if (si == "Pa s/m3") return {kBar / kLitresPerMinute, "bar per l/min"};
  if (si == "Pa s2/m6") return {kBar / (kLitresPerMinute * kLitresPerMinute), "bar per (l/min)^2"};
  const DisplayUnit shown = DisplayUnitFor(si);
  return {shown.factor, std::string(shown.name)};
}

}  // namespace hydroscope
