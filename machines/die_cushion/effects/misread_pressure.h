#pragma once

#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/pressure_root.h"

namespace hydroscope::effects {

/// What a reading of the pressure in chamber A that is too high by size x error does to the columns of the base balance, per
/// size. `error(channels...)` is that per unit size; the flow root is not linear in it and is differenced over `unit`.
template <int... kChannels, typename Error>
EffectVariant MisreadPressure(double unit, Error error) {
  const auto shift = [unit](double root, double y, double off) {
    return RootShift(root, y, unit * off) * (1.0 / unit);
  };
  const auto less = [error](auto... x) { return -error(x...); };
  const auto flow = IntegralOverTime<kFlowRoot, kSpool, kChannels...>(
      [=](double root, double y, auto... x) { return y * shift(root, y, error(x...)); });
  const auto dead_volume = ChangeOf<kChannels...>(less);
  const auto stroke_volume = IntegralOver(Of<kPosition>(), Of<kChannels...>(less));
  const auto null = IntegralOverTime<kFlowRoot, kSpool, kChannels...>(
      [=](double root, double y, auto... x) { return shift(root, y, error(x...)); });
  return EffectVariant{{flow, dead_volume, stroke_volume, null}, BaseWeights};
}

}  // namespace hydroscope::effects
