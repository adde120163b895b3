
#include <algorithm>
#include <cmath>

#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"

namespace hydroscope::effects {
namespace {

/// Share of the turbulent flow that a laminar edge lets through less, per square of its transition pressure:
/// (1 + (p_lam / dp)^2)^(-1/4) - 1, over p_lam^2.
double LaminarLoss(double root, double transition) {
  const double ratio = transition / std::max(root * root, 1e-3 * transition);
  return (1.0 / std::sqrt(std::sqrt(1.0 + ratio * ratio)) - 1.0) / (transition * transition);
}

}  // namespace

/// The metering edge is laminar at small pressure differences: Q = k y dp / (dp^2 + p_lam^2)^(1/4), turbulent
/// far above the transition pressure p_lam, in proportion to dp far below (Ellman and Piche 1999, smooth
/// transition; Merritt 1967, sec. 3-4, discharge at low Reynolds numbers). What the strokes show goes with
/// S = p_lam^2.
Effect LaminarEdge(const CushionGeometry&) {
  Effect e;
  e.id = "laminar_edge";
  e.title = "Metering edge laminar at small pressure differences";
  e.law = "Q = k y dp / (dp^2 + S)^(1/4), S = p_lam^2";
  e.source = "Ellman and Piche 1999; Merritt 1967, sec. 3-4";
  e.parameter = "S";
  e.unit = "Pa2";
  e.max = 1e14;
  e.typical = 2.5e11;
  e.nonlinear = {{"p_lam", "Pa", 1e4, 100e5}};
  e.implied = [](const ShapeContext& c) { return std::sqrt(std::max(c.size, 0.0)); };
  e.family = {"the valve lets through another flow than its opening says",
              "das Ventil lässt einen anderen Durchfluss durch, als seine Öffnung sagt"};
  e.where = [](const std::vector<double>& at) {
    return Tell("below {:.0f} bar", "unter {:.0f} bar", 1e-5 * at[0]);
  };
  e.confused_with = {"pressure_offset", "tank_pressure", "orifice_leakage"};
  e.hidden_in = "Q_vn";
  e.plain =
      "The valve lets through less than the root of the pressure says where the pressure difference is "
      "small; look for: cold or thick oil, a very small opening, strokes near tank pressure.";
  e.german = {
      "Steuerkante bei kleinen Druckdifferenzen laminar",
      "Das Ventil lässt bei kleiner Druckdifferenz weniger durch, als die Wurzel des Drucks angibt; zu "
      "suchen: kaltes oder dickes Öl, eine sehr kleine Öffnung, Hübe nahe dem Tankdruck.",
      "Hübe bei einigen bar und bei Arbeitsdruck, und dasselbe noch einmal mit warmem Öl: eine laminare "
      "Kante folgt der Viskosität, ein Nullpunktfehler nicht"};
  e.told_apart_by =
      "strokes at a pressure of a few bar and at a working pressure, and the same again with warm oil: a "
      "laminar edge follows the viscosity, a zero error does not";
  e.walks = true;
  e.variant = [](const std::vector<double>& nonlinear) {
    const double transition = nonlinear[0];
    const auto flow = IntegralOverTime<kFlowRoot, kSpool>(
        [transition](double root, double y) { return root * y * LaminarLoss(root, transition); });
    const auto null = IntegralOverTime<kFlowRoot>(
        [transition](double root) { return root * LaminarLoss(root, transition); });
    return EffectVariant{{flow, null}, WeightsOf<kFlowArea, kFlowNull>};
  };
  e.grid = {{5e5}, {20e5}};
  return e;
}

}  // namespace hydroscope::effects
