#include "machines/pump/effects/effects.h"

namespace hydroscope {

std::vector<std::shared_ptr<const Effect>> PumpEffects(const Machine&) {
  return {
#define HYDROSCOPE_LIST_EFFECT(Name) std::make_shared<const Effect>(pump::Name()),
      HYDROSCOPE_PUMP_EFFECTS(HYDROSCOPE_LIST_EFFECT)
#undef HYDROSCOPE_LIST_EFFECT
  };
}

}  // namespace hydroscope
