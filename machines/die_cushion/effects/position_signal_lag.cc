#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/low_passed_signal.h"
#include "machines/die_cushion/effects/shifted_signal.h"
#include "models/wide_stretch.h"

namespace hydroscope::effects {

/// The position reading follows the position as a first-order lag tau. Its balance then holds for what the
/// same lag makes of the other side: flow and compression behind the lag in place of flow and compression.
/// (lagged x - x) / tau, integrated, is minus lagged x.
Effect PositionSignalLag(const CushionGeometry&) {
  Effect e = FirstOrderLag();
  e.id = "position_signal_lag";
  e.title = "Position signal lags (first-order filter)";
  e.law = "z = z_measured + tau dz_measured/dt";
  e.source = "eq. 1 of the press paper with the signal filtered";
  e.confused_with = {"position_signal_delay", "spool_signal_delay", "pressure_signal_delay"};
  e.hidden_in = "V0, K";
  e.plain =
      "The position is smoothed before it is recorded; look for: a filter in the encoder interface or in the "
      "controller.";
  e.told_apart_by = "the filter setting of the position input, or a ram start recorded with a second sensor";
  e.variant = [](const std::vector<double>& nonlinear) {
    const double lag = nonlinear[0];
    const auto flow = [lag](const Stretch& s, double&, std::span<double> out) {
      const double *root = s[kFlowRoot], *y = s[kSpool];
      const double* lagged = LowPassed(s, lag, [=](int k) { return root[k] * y[k]; });
      Differences(
          s, [=](int k) { return -lagged[k]; }, out);
    };
    const auto dead_volume = [lag](const Stretch& s, double&, std::span<double> out) {
      const double* rate = s[kPressureRate];
      const double* lagged = LowPassed(s, lag, [=](int k) { return rate[k]; });
      Differences(
          s, [=](int k) { return -lagged[k]; }, out);
    };
    const auto stroke_volume = [lag](const Stretch& s, double&, std::span<double> out) {
      const double *rate = s[kPressureRate], *z = s[kPosition];
      const double* lagged = LowPassed(s, lag, [=](int k) { return rate[k]; });
      IntegrateOver(
          s, [=](int k) { return z[k]; }, [=](int k) { return -lagged[k]; }, out);
    };
    const auto null = [lag](const Stretch& s, double&, std::span<double> out) {
      const double* root = s[kFlowRoot];
      const double* lagged = LowPassed(s, lag, [=](int k) { return root[k]; });
      Differences(
          s, [=](int k) { return -lagged[k]; }, out);
    };
    return EffectVariant{{flow, dead_volume, stroke_volume, null}, [](const ShapeContext& c) {
                           return std::vector<double>{c.theta[0], c.theta[1], c.theta[2], c.theta[3]};
                         }};
  };
  // A lag is a delay to first order; whole samples keep the noise of levels white.
  e.correct = [](double lag, double&, Stretch& s) {
    ShiftChannels(
        s, {kPressureA, kSpool, kPressureB, kSupplyPressure, kOilTemperature, kFlowRoot, kPressureRate},
        -lag);
    FillLogarithms(s);
  };
  e.grid = {{0.006}};
  return e;
}

}  // namespace hydroscope::effects
