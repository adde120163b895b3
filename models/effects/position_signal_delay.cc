#include "models/effects/effects.h"

namespace hydroscope::effects {

/// The position signal arrives t late: z = z_measured + t dz/dt, so A_A dz/dt on the left gains A_A t d2z/dt2.
Effect PositionSignalDelay(const CushionGeometry& geometry) {
  Effect e;
  e.id = "position_signal_delay";
  e.title = "Position signal arrives late";
  e.law = "z(t) = z_measured(t + t_d)";
  e.source = "first-order expansion of eq. 1 of the press paper";
  e.parameter = "t_d";
  e.unit = "s";
  e.max = 0.05;
  e.typical = 0.002;
  e.confused_with = {"spool_signal_delay", "pressure_signal_delay"};
  e.hidden_in = "V0, K";
  e.plain = "The position is recorded later than the other signals; look for: a slow encoder interface, a filter, a bus cycle.";
  e.variant = [area = geometry.piston_area](const auto&) {
    return PlainVariant([area](const Stretch& s, double&, std::span<double> out) {
      const double* v = s[kSpeed];
      Differences(s, [=](int k) { return -area * v[k]; }, out);
    });
  };
  return e;
}

}  // namespace hydroscope::effects
