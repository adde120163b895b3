#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/shifted_signal.h"
#include "machines/die_cushion/effects/strokes.h"
#include "models/wide_stretch.h"

namespace hydroscope::effects {

/// The position signal arrives t_d late: z(t + t_d) in place of z(t), in the piston volume and in the compressed volume.
Effect PositionSignalDelay(const CushionGeometry&) {
  Effect e = LateSignal();
  e.id = "position_signal_delay";
  e.title = "Position signal arrives late";
  e.law = "z(t) = z_measured(t + t_d)";
  e.source = "eq. 1 of the press paper with the signal shifted";
  e.family = {"the position is recorded late", "die Position wird verspätet aufgezeichnet"};
  e.confused_with = {"spool_signal_delay", "pressure_signal_delay"};
  e.hidden_in = "V0, K";
  e.plain =
      "The position is recorded later than the other signals; look for: a slow "
      "encoder interface, a filter, a bus cycle.";
  e.german = {"Wegsignal kommt verspätet",
              "Der Weg wird später aufgezeichnet als die anderen Signale; zu suchen: eine langsame "
              "Schnittstelle des Gebers, ein Filter, ein Buszyklus."};
  e.shown_by = kSteps;
  e.variant = [](const std::vector<double>& nonlinear) {
    const double delay = nonlinear[0];
    const auto flow = [delay](const Stretch& s, double&, std::span<double> out) {
      const double *root = s[kFlowRoot], *y = s[kSpool];
      const ShiftedSignal root_before(s, kFlowRoot, -delay), y_before(s, kSpool, -delay);
      wide::IntegrateOverTime(
          s,
          [&, per_second = 1.0 / delay](int k) {
            return (root_before(k) * y_before(k) - root[k] * y[k]) * per_second;
          },
          out);
    };
    // (p(t - t_d) - p(t)) / t_d is minus the mean of the rate.
    const auto dead_volume = [delay](const Stretch& s, double&, std::span<double> out) {
      const MeanOverShift rate(s, kPressureRate, -delay);
      wide::Differences(
          s, [&](int k) { return -rate(k); }, out);
    };
    const auto stroke_volume = [delay](const Stretch& s, double&, std::span<double> out) {
      const double* z = s[kPosition];
      const MeanOverShift rate(s, kPressureRate, -delay);
      wide::IntegrateOver(
          s, [=](int k) { return z[k]; }, [&](int k) { return -rate(k); }, out);
    };
    const auto null = [delay](const Stretch& s, double&, std::span<double> out) {
      const double* root = s[kFlowRoot];
      const ShiftedSignal before(s, kFlowRoot, -delay);
      wide::IntegrateOverTime(
          s, [&, per_second = 1.0 / delay](int k) { return (before(k) - root[k]) * per_second; }, out);
    };
    return EffectVariant{{flow, dead_volume, stroke_volume, null}, BaseWeights};
  };
  // The other signals as they were when the position was what is read now, as in the columns above.
  e.correct = [](double delay, double&, Stretch& s) {
    ShiftChannels(
        s, {kPressureA, kSpool, kPressureB, kSupplyPressure, kOilTemperature, kFlowRoot, kPressureRate},
        -delay);
    FillLogarithms(s);
  };
  return e;
}

}  // namespace hydroscope::effects
