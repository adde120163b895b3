#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/pressure_root.h"

namespace hydroscope::effects {

/// The pressure sensor reads (1 + g) times the pressure: flow and compression go with p / (1 + g). To a tank
/// without pressure that is another Q_vn and another K, and no stroke shows it; edges to the supply do.
Effect PressureGain(const CushionGeometry&) {
  Effect e;
  e.id = "pressure_gain";
  e.title = "Scale error of the pressure sensor of chamber A";
  e.law = "p_A = p_measured / (1 + g)";
  e.source = "eq. 1-2 of the press paper with the pressure scaled";
  e.parameter = "g";
  e.unit = "1";
  e.min = -0.3;
  e.max = 0.3;
  e.typical = 0.02;
  e.nonlinear = {{"gain", "1", -0.3, 0.3}};
  e.implied = [](const ShapeContext& c) { return c.size; };
  e.family = {"the pressure reading is off", "der Druck wird falsch angezeigt"};
  e.confused_with = {"pressure_offset", "tank_pressure"};
  e.hidden_in = "K, Q_vn";
  e.plain =
      "The pressure sensor reads too much or too little in proportion; look for: a wrong range in the "
      "controller, a sensor of another range, a wrong scale in the machine file.";
  e.german = {
      "Skalenfehler des Drucksensors der Kammer A",
      "Der Drucksensor zeigt im Verhältnis zu viel oder zu wenig; zu suchen: ein falscher Messbereich "
      "in der Steuerung, ein Sensor anderen Bereichs, ein falscher Faktor in der Maschinendatei.",
      "ein Vergleichsmanometer neben dem Sensor bei zwei Drücken: Hübe allein halten einen falschen "
      "Faktor für ein anderes Q_vn und K"};
  e.told_apart_by =
      "a reference gauge beside the sensor at two pressures: strokes alone "
      "take a wrong scale for another Q_vn and K";
  e.walks = true;
  e.variant = [](const std::vector<double>& nonlinear) {
    const double gain = nonlinear[0], too_much = gain / (1.0 + gain);
    const auto flow = IntegralOverTime<kFlowRoot, kSpool, kPressureA>(
        [=](double root, double y, double p) { return y * RootShift(root, y, too_much * p) * (1.0 / gain); });
    const auto dead_volume = ChangeOf<kPressureA>([=](double p) { return -p / (1.0 + gain); });
    const auto stroke_volume =
        IntegralOver(Of<kPosition>(), Of<kPressureA>([=](double p) { return -p / (1.0 + gain); }));
    const auto null = IntegralOverTime<kFlowRoot, kSpool, kPressureA>(
        [=](double root, double y, double p) { return RootShift(root, y, too_much * p) * (1.0 / gain); });
    return EffectVariant{{flow, dead_volume, stroke_volume, null}, BaseWeights};
  };
  e.correct = [](double gain, double&, Stretch& s) {
    double *p = s[kPressureA], *root = s[kFlowRoot], *rate = s[kPressureRate];
    const double* y = s[kSpool];
    for (int k = -s.before; k < s.samples + s.after; ++k) {
      root[k] += RootShift(root[k], y[k], gain / (1.0 + gain) * p[k]);
      p[k] /= 1.0 + gain;
      rate[k] /= 1.0 + gain;
    }
    FillLogarithms(s);
  };
  e.grid = {{0.05}};
  return e;
}

}  // namespace hydroscope::effects
