#pragma once

#include <string>
#include <string_view>

#include "core/units.h"

namespace hydroscope {

/// A unit as people read it for the size of an effect: "m3/(s Pa)" -> "l/min per bar".
struct EffectUnit {
  double factor = 1.0;  ///< shown = SI * factor
  std::string name;     ///< "-" for numbers without unit
};
EffectUnit EffectUnitFor(std::string_view si);
/// The same; the name lives as long as `si` or the program.
DisplayUnit DisplayUnitOfEffect(std::string_view si);

}  // namespace hydroscope
