#pragma once

#include <memory>
#include <vector>

#include "models/effect.h"
#include "models/machine.h"

namespace hydroscope {

/// Effects of the pump: one law, one file. To add one, write its file and a line here.
#define HYDROSCOPE_PUMP_EFFECTS(_) \
  _(LeakageGrown)                  \
  _(StickingSpool)                 \
  _(WeakSpring)                    \
  _(SuctionAir)                    \
  _(SwashBearing)                  \
  _(OutletLeakage)

namespace pump {
#define HYDROSCOPE_DECLARE_EFFECT(Name) Effect Name();
HYDROSCOPE_PUMP_EFFECTS(HYDROSCOPE_DECLARE_EFFECT)
#undef HYDROSCOPE_DECLARE_EFFECT
}  // namespace pump

std::vector<std::shared_ptr<const Effect>> PumpEffects(const Machine&);

}  // namespace hydroscope
