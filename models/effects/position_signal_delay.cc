#include "models/effects/effects.h"

namespace hydroscope::effects {

/// The position signal arrives t late: z = z_measured + t dz/dt + t^2/2 d2z/dt2, and the piston volume with it.
Effect PositionSignalDelay(const CushionGeometry& geometry) {
  Effect e;
  e.id = "position_signal_delay";
  e.title = "Position signal arrives late";
  e.law = "z(t) = z_measured(t + t_d)";
  e.source = "second-order expansion of eq. 1 of the press paper";
  e.parameter = "t_d";
  e.unit = "s";
  e.max = 0.05;
  e.typical = 0.002;
  e.confused_with = {"spool_signal_delay", "pressure_signal_delay"};
  e.hidden_in = "V0, K";
  e.plain = "The position is recorded later than the other signals; look for: a slow encoder interface, a filter, a bus cycle.";
  e.variant = [area = geometry.piston_area](const auto&) {
    const auto first_order = [area](const Stretch& s, double&, std::span<double> out) {
      const double* v = s[kSpeed];
      Differences(s, [=](int k) { return -area * v[k]; }, out);
    };
    const auto second_order = [area](const Stretch& s, double&, std::span<double> out) {
      const double* a = s[kAcceleration];
      Differences(s, [=](int k) { return -area * a[k]; }, out);
    };
    return EffectVariant{{first_order, second_order},
                         [](const ShapeContext& c) { return std::vector<double>{1.0, 0.5 * c.size}; }};
  };
  return e;
}

}  // namespace hydroscope::effects
