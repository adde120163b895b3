#include "machines/flexible_axis/effects/effects.h"

namespace hydroscope {

std::vector<std::shared_ptr<const Effect>> FlexibleAxisEffects(const Machine&) {
  return {
#define HYDROSCOPE_LIST_EFFECT(Name) std::make_shared<const Effect>(flexible_axis::Name()),
      HYDROSCOPE_FLEXIBLE_AXIS_EFFECTS(HYDROSCOPE_LIST_EFFECT)
#undef HYDROSCOPE_LIST_EFFECT
  };
}

}  // namespace hydroscope
