#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/shifted_signal.h"
#include "machines/die_cushion/effects/strokes.h"
#include "models/wide_stretch.h"

namespace hydroscope::effects {

/// The pressure signal arrives t_d late: p_A(t + t_d) in place of p_A(t), in the flow through the valve and
/// in the compressed volume alike.
Effect PressureSignalDelay(const CushionGeometry&) {
  Effect e = LateSignal();
  e.id = "pressure_signal_delay";
  e.title = "Pressure signal arrives late";
  e.law = "p_A(t) = p_measured(t + t_d)";
  e.source = "eq. 1-2 of the press paper with the signal shifted";
  e.family = {"the pressure is recorded late", "der Druck wird verspätet aufgezeichnet"};
  e.confused_with = {"spool_signal_delay", "position_signal_delay"};
  e.hidden_in = "V0, K";
  e.plain =
      "The pressure is recorded later than the other signals; look for: a filter in "
      "the amplifier, a long dead sensor line.";
  e.german = {"Drucksignal kommt verspätet",
              "Der Druck wird später aufgezeichnet als die anderen Signale; zu suchen: ein Filter im "
              "Verstärker, eine lange tote Messleitung."};
  e.shown_by = kSteps;
  e.separations = {{"position_signal_delay", kSteps}};
  e.variant = [](const std::vector<double>& nonlinear) {
    const double delay = nonlinear[0];
    const auto flow = [delay](const Stretch& s, double&, std::span<double> out) {
      const double *root = s[kFlowRoot], *y = s[kSpool];
      const ShiftedSignal later(s, kFlowRoot, delay);
      wide::IntegrateOverTime(
          s, [&, per_second = 1.0 / delay](int k) { return y[k] * (later(k) - root[k]) * per_second; }, out);
    };
    // (p(t + t_d) - p(t)) / t_d is the mean of the rate.
    const auto dead_volume = [delay](const Stretch& s, double&, std::span<double> out) {
      const MeanOverShift rate(s, kPressureRate, delay);
      wide::Differences(
          s, [&](int k) { return rate(k); }, out);
    };
    const auto stroke_volume = [delay](const Stretch& s, double&, std::span<double> out) {
      const double* z = s[kPosition];
      const MeanOverShift rate(s, kPressureRate, delay);
      wide::IntegrateOver(
          s, [=](int k) { return z[k]; }, [&](int k) { return rate(k); }, out);
    };
    const auto null = [delay](const Stretch& s, double&, std::span<double> out) {
      const double* root = s[kFlowRoot];
      const ShiftedSignal later(s, kFlowRoot, delay);
      wide::IntegrateOverTime(
          s, [&, per_second = 1.0 / delay](int k) { return (later(k) - root[k]) * per_second; }, out);
    };
    return EffectVariant{{flow, dead_volume, stroke_volume, null}, BaseWeights};
  };
  e.correct = [](double delay, double&, Stretch& s) {
    ShiftChannels(s, {kPressureA, kFlowRoot, kPressureRate}, delay);
    FillLogarithms(s);
  };
  return e;
}

}  // namespace hydroscope::effects
