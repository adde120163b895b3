#include "models/effects/effects.h"

namespace hydroscope::effects {

/// The spool signal arrives t late: the true opening is y_v + t dy_v/dt to first order, so the flow gains
/// theta1 t integral root(dp) dy_v.
Effect SpoolSignalDelay(const CushionGeometry&) {
  Effect e;
  e.id = "spool_signal_delay";
  e.title = "Spool signal arrives late";
  e.law = "y_v(t) = y_measured(t + t_d)";
  e.source = "first-order expansion of eq. 2 of the press paper";
  e.parameter = "t_d";
  e.unit = "s";
  e.max = 0.05;
  e.typical = 0.002;
  e.confused_with = {"pressure_signal_delay", "position_signal_delay", "spool_hysteresis"};
  e.hidden_in = "V0, K";
  e.plain = "The spool position is recorded later than the other signals; look for: a filter in the transducer, a bus cycle.";
  e.variant = [](const auto&) {
    const auto flow = [](const Stretch& s, double&, std::span<double> out) {
      const double *root = s[kFlowRoot], *y = s[kSpool];
      IntegrateOver(s, [=](int k) { return root[k]; }, [=](int k) { return y[k]; }, out);
    };
    return EffectVariant{{flow}, [](const ShapeContext& c) { return std::vector<double>{c.theta[0]}; }};
  };
  return e;
}

}  // namespace hydroscope::effects
