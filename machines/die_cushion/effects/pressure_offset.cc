#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/pressure_root.h"
#include "machines/die_cushion/effects/strokes.h"

namespace hydroscope::effects {
namespace {

/// Change of the flow root with a zero error b, per b.
double RootChange(double root, double y, double b) { return RootShift(root, y, b) * (1.0 / b); }

}  // namespace

/// Zero error b of the pressure sensor: the true pressure is p - b, so the flow through the valve goes with
/// root(p - b).
Effect PressureOffset(const CushionGeometry&) {
  Effect e;
  e.id = "pressure_offset";
  e.title = "Zero error of the pressure sensor of chamber A";
  e.law = "p_A = p_measured - b";
  e.source = "eq. 2 of the press paper with the pressure shifted";
  e.parameter = "b";
  e.unit = "Pa";
  e.min = -100e5;
  e.max = 100e5;
  e.typical = 2e5;
  e.nonlinear = {{"offset", "Pa", -100e5, 100e5}};
  e.implied = [](const ShapeContext& c) { return c.size; };
  e.family = {"the pressure reading is off", "der Druck wird falsch angezeigt"};
  e.confused_with = {"orifice_leakage", "external_leakage", "tank_pressure"};
  e.hidden_in = "Q_vn, y_0";
  e.plain =
      "The pressure sensor does not read zero without pressure; look for: a drifted sensor, a wrong scale in "
      "the controller. Check it with the cushion relieved.";
  e.german = {
      "Nullpunktfehler des Drucksensors der Kammer A",
      "Der Drucksensor zeigt ohne Druck nicht null; zu suchen: ein gedrifteter Sensor, ein falscher "
      "Faktor in der Steuerung. Bei entlastetem Kissen prüfen.",
      "der Drucksensor mit zur Luft entlüfteter Leitung: er muss null zeigen; nur zum Tank entlastet, "
      "liest sich ein Rückschlagventil oder eine Vorspannung der Tankleitung als ihr eigener Druck"};
  e.told_apart_by =
      "the pressure sensor with its line vented to the air: it must read zero; relieved to tank only, a "
      "check valve or a preload in the tank line reads as its own pressure";
  e.measured_by = {"the reading of the pressure sensor with its line vented to the air",
                   "die Anzeige des Drucksensors bei zur Luft geöffneter Leitung"};
  e.shown_by = kRelieved;
  e.walks = true;
  e.variant = [](const std::vector<double>& nonlinear) {
    const auto flow = IntegralOverTime<kFlowRoot, kSpool>(
        [b = nonlinear[0]](double root, double y) { return y * RootChange(root, y, b); });
    const auto null = IntegralOverTime<kFlowRoot, kSpool>(
        [b = nonlinear[0]](double root, double y) { return RootChange(root, y, b); });
    return EffectVariant{{flow, null}, WeightsOf<kFlowArea, kFlowNull>};
  };
  e.correct = [](double b, double&, Stretch& s) {
    double *p = s[kPressureA], *root = s[kFlowRoot];
    const double* y = s[kSpool];
    for (int k = -s.before; k < s.samples + s.after; ++k) root[k] += b * RootChange(root[k], y[k], b);
    for (int k = -s.before; k < s.samples + s.after; ++k) p[k] -= b;
    FillLogarithms(s);
  };
  e.grid = {{-5e5}, {5e5}};
  return e;
}

}  // namespace hydroscope::effects
