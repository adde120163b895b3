#include "models/effects/effects.h"

namespace hydroscope::effects {

/// The return line drops R Q^2 behind the valve. With k = -theta1 and u = y_v - y_0 the flow becomes
/// k u root(dp) / sqrt(1 + R k^2 u^2) = k u root(dp) (1 - x/2 + 3 x^2/8 - ...), x = R k^2 u^2
/// (two turbulent restrictions in series, Merritt 1967, sec. 3-4).
Effect TankBackPressure(const CushionGeometry&) {
  Effect e;
  e.id = "tank_back_pressure";
  e.title = "Back pressure in the return line";
  e.law = "p_T = p_t + R Q^2 behind the valve";
  e.source = "Merritt 1967, sec. 3-4 (orifices in series)";
  e.parameter = "R";
  e.unit = "Pa s2/m6";
  e.max = 1e14;
  e.typical = 2e11;
  e.confused_with = {"valve_flow_curvature"};
  e.hidden_in = "Q_vn";
  e.plain =
      "The way from the valve to tank chokes large flows; look for: a clogged return filter, a half-closed cock, a "
      "squeezed return hose.";
  e.columns = {{"tank_back_pressure_y3",
                [](const Stretch& s, double&, std::span<double> out) {
                  const double *root = s[kFlowRoot], *y = s[kSpool];
                  IntegrateOverTime(s, [=](int k) { return root[k] * y[k] * y[k] * y[k]; }, out);
                }},
               {"tank_back_pressure_y2",
                [](const Stretch& s, double&, std::span<double> out) {
                  const double *root = s[kFlowRoot], *y = s[kSpool];
                  IntegrateOverTime(s, [=](int k) { return root[k] * y[k] * y[k]; }, out);
                }},
               {"tank_back_pressure_y5", [](const Stretch& s, double&, std::span<double> out) {
                  const double *root = s[kFlowRoot], *y = s[kSpool];
                  IntegrateOverTime(
                      s,
                      [=](int k) {
                        const double y2 = y[k] * y[k];
                        return root[k] * y2 * y2 * y[k];
                      },
                      out);
                }}};
  e.shapes = {{{0, 1, 2},
               [](const ShapeContext& c) {
                 const double k = -c.theta[0], null = -c.theta[3] / c.theta[0];
                 const double cubic = 0.5 * k * k * k;
                 return std::vector<double>{cubic, -3.0 * null * cubic, -0.375 * c.size * k * k * k * k * k};
               },
               {}}};
  return e;
}

}  // namespace hydroscope::effects
