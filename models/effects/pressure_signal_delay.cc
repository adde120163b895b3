#include "models/effects/effects.h"

namespace hydroscope::effects {

/// The pressure signal arrives t late: p_A = p + t dp/dt to first order, in the flow through the valve and in the
/// compressed volume alike.
Effect PressureSignalDelay(const CushionGeometry&) {
  Effect e;
  e.id = "pressure_signal_delay";
  e.title = "Pressure signal arrives late";
  e.law = "p_A(t) = p_measured(t + t_d)";
  e.source = "first-order expansion of eq. 1-2 of the press paper";
  e.parameter = "t_d";
  e.unit = "s";
  e.max = 0.05;
  e.typical = 0.002;
  e.confused_with = {"spool_signal_delay", "position_signal_delay"};
  e.hidden_in = "V0, K";
  e.plain = "The pressure is recorded later than the other signals; look for: a filter in the amplifier, a long dead sensor line.";
  e.variant = [](const auto&) {
    const auto flow = [](const Stretch& s, double&, std::span<double> out) {
      const double *root = s[kFlowRoot], *y = s[kSpool];
      IntegrateOver(s, [=](int k) { return y[k]; }, [=](int k) { return root[k]; }, out);
    };
    const auto dead_volume = [](const Stretch& s, double&, std::span<double> out) {
      const double* rate = s[kPressureRate];
      Differences(s, [=](int k) { return rate[k]; }, out);
    };
    const auto stroke_volume = [](const Stretch& s, double&, std::span<double> out) {
      const double *rate = s[kPressureRate], *z = s[kPosition];
      IntegrateOver(s, [=](int k) { return z[k]; }, [=](int k) { return rate[k]; }, out);
    };
    const auto null = [](const Stretch& s, double&, std::span<double> out) {
      const double* root = s[kFlowRoot];
      Differences(s, [=](int k) { return root[k]; }, out);
    };
    return EffectVariant{{flow, dead_volume, stroke_volume, null}, [](const ShapeContext& c) {
                           return std::vector<double>{c.theta[0], c.theta[1], c.theta[2], c.theta[3]};
                         }};
  };
  return e;
}

}  // namespace hydroscope::effects
