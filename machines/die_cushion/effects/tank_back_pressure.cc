#include <cmath>

#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/strokes.h"

namespace hydroscope::effects {
namespace {

/// Flow lost to the back pressure per full-opening flow: u - u / sqrt(1 + x u^2), and its slope.
double Lost(double u, double x) { return u - u / std::sqrt(1.0 + x * u * u); }
double LostSlope(double u, double x) {
  const double root = std::sqrt(1.0 + x * u * u);
  return 1.0 - 1.0 / (root * root * root);
}

}  // namespace

/// The return line drops R Q^2 behind the valve. With k = -theta1 and u = y_v - y_0 the flow becomes
/// k u root(dp) / sqrt(1 + R k^2 u^2) (two turbulent restrictions in series, Merritt 1967, sec. 3-4). The
/// choke ratio x = R k^2 is the nonlinear parameter; y_0 enters by its slope.
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
  e.nonlinear = {{"x", "1", 0.01, 30.0}};
  e.implied = [](const ShapeContext& c) { return c.size * c.theta[0] * c.theta[0]; };
  e.family = {"what flows to the tank meets another pressure",
              "was zum Tank fließt, trifft auf einen anderen Druck"};
  e.confused_with = {"valve_flow_curvature"};
  e.hidden_in = "Q_vn";
  e.plain =
      "The way from the valve to tank chokes large flows; look for: a clogged return filter, a half-closed "
      "cock, a squeezed return hose.";
  e.german = {"Staudruck in der Rücklaufleitung",
              "Der Weg vom Ventil zum Tank drosselt große Durchflüsse; zu suchen: ein zugesetzter "
              "Rücklauffilter, ein halb geschlossener Hahn, ein gequetschter Rücklaufschlauch."};
  e.shown_by = kOpenings;
  e.separations = {{"valve_flow_curvature", kOpenings}, {"spool_overlap", kOpenings}};
  e.walks = true;
  e.variant = [](const std::vector<double>& nonlinear) {
    const double x = nonlinear[0];
    const auto flow =
        IntegralOverTime<kFlowRoot, kSpool>([x](double root, double y) { return root * Lost(y, x); });
    const auto null =
        IntegralOverTime<kFlowRoot, kSpool>([x](double root, double y) { return root * LostSlope(y, x); });
    return EffectVariant{{flow, null}, [x](const ShapeContext& c) {
                           const double k = -c.theta[0], null = -c.theta[3] / c.theta[0];
                           return std::vector<double>{k * k * k / x, -null * k * k * k / x};
                         }};
  };
  e.grid = {{0.2}, {1.0}, {3.0}, {9.0}};
  return e;
}

}  // namespace hydroscope::effects
