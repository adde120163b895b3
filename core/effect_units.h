#pragma once

#include <string>
#include <string_view>

namespace hydroscope {

/// A unit as people read it for the size of an effect: "m3/(s Pa)" -> "l/min per bar".
struct EffectUnit {
  double factor = 1.0;  ///< shown = SI * factor
  std::string name;     ///< "-" for numbers without unit
};
EffectUnit EffectUnitFor(std::string_view si);

}  // namespace hydroscope
