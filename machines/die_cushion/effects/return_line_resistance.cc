#include <algorithm>
#include <cmath>

#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"

namespace hydroscope::effects {
namespace {

/// Flow lost to a laminar return line per k: with Q = k y root(dp - R Q) and x = k R, Q / k = y (hypot(root,
/// x y / 2) - x y / 2), less what y root(dp) promises.
double LostToLine(double root, double y, double x) {
  const double half = 0.5 * x * std::max(y, 0.0), drop = std::max(root, 0.0);
  return std::max(y, 0.0) * (drop + half - std::sqrt(drop * drop + half * half));
}
/// Its slope over y.
double LostToLineSlope(double root, double y, double x) {
  const double half = 0.5 * x * std::max(y, 0.0), drop = std::max(root, 0.0);
  const double whole = std::sqrt(drop * drop + half * half) + 1e-9;
  return y > 0 ? drop + half - whole + half * (1.0 - half / whole) : 0.0;
}

}  // namespace

/// The return line drops R_1 Q behind the valve, as a long or narrow line does in laminar flow (Merritt 1967,
/// sec. 2-4, Hagen-Poiseuille). The ratio x = k R_1, k = -theta1, is the nonlinear parameter; y_0 enters by its slope.
Effect ReturnLineResistance(const CushionGeometry&) {
  Effect e;
  e.id = "return_line_resistance";
  e.title = "Laminar resistance of the return line";
  e.law = "p_T = p_t + R_1 Q behind the valve";
  e.source = "Merritt 1967, sec. 2-4 (Hagen-Poiseuille)";
  e.parameter = "R_1";
  e.unit = "Pa s/m3";
  e.max = 1e11;
  e.typical = 2e8;
  e.nonlinear = {{"x", "sqrt(Pa)", 1.0, 3e4}};
  e.implied = [](const ShapeContext& c) { return -c.size * c.theta[0]; };
  e.family = {"what flows to the tank meets another pressure",
              "was zum Tank fließt, trifft auf einen anderen Druck"};
  e.confused_with = {"tank_back_pressure", "valve_flow_curvature"};
  e.hidden_in = "Q_vn";
  e.plain =
      "The way from the valve to tank resists in proportion to the flow; look for: a long or narrow return "
      "hose, a cooler in the return line, cold oil.";
  e.german = {
      "Laminarer Widerstand der Rücklaufleitung",
      "Der Weg vom Ventil zum Tank setzt dem Durchfluss einen Widerstand im Verhältnis zu ihm entgegen; "
      "zu suchen: ein langer oder enger Rücklaufschlauch, ein Kühler im Rücklauf, kaltes Öl.",
      "ein Manometer gleich hinter dem Ventil, bei einem langsamen und einem schnellen Hub abgelesen: "
      "der Abfall verdoppelt sich mit dem Durchfluss in einer laminaren Leitung und vervierfacht sich "
      "in einer Blende"};
  e.told_apart_by =
      "a pressure gauge right behind the valve, read at a slow and at a fast stroke: the drop doubles with "
      "the flow in a laminar line and grows fourfold in an orifice";
  e.walks = true;
  e.variant = [](const std::vector<double>& nonlinear) {
    const double x = nonlinear[0];
    const auto flow =
        IntegralOverTime<kFlowRoot, kSpool>([x](double root, double y) { return LostToLine(root, y, x); });
    const auto null = IntegralOverTime<kFlowRoot, kSpool>(
        [x](double root, double y) { return LostToLineSlope(root, y, x); });
    return EffectVariant{{flow, null}, [x](const ShapeContext& c) {
                           const double k = -c.theta[0], null = -c.theta[3] / c.theta[0];
                           return std::vector<double>{k * k / x, -null * k * k / x};
                         }};
  };
  e.grid = {{200.0}, {1000.0}, {5000.0}};
  return e;
}

}  // namespace hydroscope::effects
