#pragma once

#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/pressure_root.h"
#include "models/wide_stretch.h"

namespace hydroscope::effects {

/// What a reading of the pressure in chamber A that is too high by size x error does to the columns of the base balance, per
/// size; weights: BaseWeights. `error(s)` gives the error at sample k per unit size; the flow root, which is not linear in it,
/// is differenced over `unit` of the size.
template <typename Error>
EffectVariant MisreadPressure(double unit, Error error) {
  const auto shift = [unit](double root, double y, double off) {
    return RootShift(root, y, unit * off) * (1.0 / unit);
  };
  const auto flow = [=](const Stretch& s, double&, std::span<double> out) {
    const double *root = s[kFlowRoot], *y = s[kSpool];
    wide::IntegrateOverTime(
        s, [=, off = error(s)](int k) { return y[k] * shift(root[k], y[k], off(k)); }, out);
  };
  const auto dead_volume = [=](const Stretch& s, double&, std::span<double> out) {
    wide::Differences(
        s, [off = error(s)](int k) { return -off(k); }, out);
  };
  const auto stroke_volume = [=](const Stretch& s, double&, std::span<double> out) {
    const double* z = s[kPosition];
    wide::IntegrateOver(
        s, [=](int k) { return z[k]; }, [off = error(s)](int k) { return -off(k); }, out);
  };
  const auto null = [=](const Stretch& s, double&, std::span<double> out) {
    const double *root = s[kFlowRoot], *y = s[kSpool];
    wide::IntegrateOverTime(
        s, [=, off = error(s)](int k) { return shift(root[k], y[k], off(k)); }, out);
  };
  return EffectVariant{{flow, dead_volume, stroke_volume, null}, BaseWeights};
}

}  // namespace hydroscope::effects
