#include <algorithm>

#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/pressure_root.h"

namespace hydroscope::effects {

/// The tank line stands b above the pressure that the machine file gives (check valve, tank head): what flows
/// to tank goes with root(p_A - p_t - b), what comes from the supply as ever (press paper, eq. 2).
Effect TankPressure(const CushionGeometry&) {
  Effect e;
  e.id = "tank_pressure";
  e.title = "Tank line not at the pressure of the machine file";
  e.law = "p_T = p_t + b";
  e.source = "eq. 2 of the press paper with the tank pressure shifted";
  e.parameter = "b";
  e.unit = "Pa";
  e.min = -20e5;
  e.max = 60e5;
  e.typical = 2e5;
  e.nonlinear = {{"pressure", "Pa", -20e5, 60e5}};
  e.implied = [](const ShapeContext& c) { return c.size; };
  e.family = {"what flows to the tank meets another pressure",
              "was zum Tank fließt, trifft auf einen anderen Druck"};
  e.confused_with = {"pressure_offset", "orifice_leakage", "external_leakage"};
  e.twins = {{"pressure_offset"}};
  e.hidden_in = "Q_vn, y_0";
  e.plain =
      "The tank line stands at another pressure than the machine file says; look for: a check valve with a "
      "strong spring, a preloaded tank, p_t of the machine file.";
  e.german = {
      "Tankleitung nicht auf dem Druck der Maschinendatei",
      "Die Tankleitung steht unter einem anderen Druck, als die Maschinendatei sagt; zu suchen: ein "
      "Rückschlagventil mit starker Feder, ein vorgespannter Tank, p_t der Maschinendatei.",
      "der Drucksensor mit zur Luft entlüfteter Leitung, der null zeigen muss, und ein Manometer an der "
      "Tankleitung, während Öl fließt"};
  e.told_apart_by =
      "the pressure sensor with its line vented to the air, which must read zero, and "
      "a gauge on the tank line while oil flows";
  e.measured_by = {
      "what a gauge on the tank line shows while oil flows, less p_t of the machine file",
      "was ein Manometer an der Tankleitung zeigt, während Öl fließt, abzüglich p_t der Maschinendatei"};
  e.walks = true;
  e.variant = [](const std::vector<double>& nonlinear) {
    const auto flow = IntegralOverTime<kFlowRoot, kSpool>([b = nonlinear[0]](double root, double y) {
      return std::max(y, 0.0) * RootShift(root, y, b) * (1.0 / b);
    });
    const auto null = IntegralOverTime<kFlowRoot, kSpool>([b = nonlinear[0]](double root, double y) {
      return y >= 0 ? RootShift(root, y, b) * (1.0 / b) : 0.0;
    });
    return EffectVariant{{flow, null}, WeightsOf<kFlowArea, kFlowNull>};
  };
  e.correct = [](double b, double&, Stretch& s) {
    double* root = s[kFlowRoot];
    const double* y = s[kSpool];
    for (int k = -s.before; k < s.samples + s.after; ++k)
      root[k] += y[k] >= 0 ? RootShift(root[k], y[k], b) : 0.0;
  };
  e.grid = {{-5e5}, {5e5}};
  return e;
}

}  // namespace hydroscope::effects
