#include <algorithm>

#include "models/effects/effects.h"
#include "models/wide_stretch.h"

namespace hydroscope::effects {

/// Oil column between cylinder and valve: the valve sees p_A - L dQ/dt, so root(dp) loses L dQ/dt / (2
/// root(dp)) with Q = -theta1 u root(dp) (lumped inertance L = rho l / A, Merritt 1967, sec. 3-6).
Effect LineInertance(const CushionGeometry&) {
  Effect e;
  e.id = "line_inertance";
  e.title = "Inertia of the oil column between cylinder and valve";
  e.law = "p_valve = p_A - L dQ/dt";
  e.source = "Merritt 1967, sec. 3-6 (lumped line)";
  e.parameter = "L";
  e.unit = "kg/m4";
  e.max = 1e10;
  e.typical = 5e6;
  e.confused_with = {"spool_signal_delay", "pressure_signal_delay"};
  e.hidden_in = "V0";
  e.plain =
      "A long or narrow line between cylinder and valve makes the oil column swing; look for: a long hose "
      "fitted, a throttled line.";
  e.variant = [](const auto&) {
    const auto flow = [](const Stretch& s, double&, std::span<double> out) {
      const double *root = s[kFlowRoot], *y = s[kSpool];
      wide::IntegrateOver(
          s, [=](int k) { return y[k] / std::max(root[k], 300.0); }, [=](int k) { return root[k] * y[k]; },
          out);
    };
    return EffectVariant{
        {flow}, [](const ShapeContext& c) { return std::vector<double>{0.5 * c.theta[0] * c.theta[0]}; }};
  };
  return e;
}

}  // namespace hydroscope::effects
