#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/strokes.h"

namespace hydroscope::effects {

/// The valve's flow gain follows the pressure beside the root of its difference, Q_vn(p) = Q_vn (1 + c (p_A - 100 bar) / 100 bar):
/// a discharge coefficient that is none, flow forces that draw the spool from where it is read.
Effect FlowGainPressure(const CushionGeometry&) {
  Effect e;
  e.id = "flow_gain_pressure";
  e.title = "Flow gain of the valve follows the pressure";
  e.law = "Q_vn(p) = Q_vn (1 + c (p_A - 100 bar) / 100 bar)";
  e.source = "Merritt 1967, sec. 3-4 (discharge coefficient), 5-6 (flow forces)";
  e.parameter = "c";
  e.unit = "1";
  e.min = -0.2;
  e.max = 0.2;
  e.typical = 0.02;
  e.family = {"the flow through the valve goes with another power of the pressure",
              "der Durchfluss des Ventils geht mit einer anderen Potenz des Druckes"};
  e.confused_with = {"pressure_nonlinearity", "laminar_edge"};
  e.twins = {{"pressure_nonlinearity"}};
  e.hidden_in = "Q_vn";
  e.plain =
      "The valve lets through more or less with the pressure than the root of it says; look for: flow forces that move the spool, "
      "a chipped or rounded edge, a main stage that is no longer held.";
  e.german = {
      "Durchflussverstärkung des Ventils folgt dem Druck",
      "Das Ventil lässt mit dem Druck mehr oder weniger durch, als dessen Wurzel sagt; zu suchen: Strömungskräfte, die den "
      "Schieber bewegen, eine ausgebrochene oder gerundete Kante, eine Hauptstufe, die nicht mehr gehalten wird.",
      "ein Vergleichsmanometer neben dem Drucksensor bei drei Drücken: stimmen beide überein, liegt es am Ventil"};
  e.told_apart_by =
      "a reference gauge beside the pressure sensor at three pressures: where both agree, the valve is the cause";
  e.shown_by = kPressureSteps;
  e.walks = true;
  e.variant = [](const auto&) {
    const auto flow = IntegralOverTime<kFlowRoot, kSpool, kPressureA>([](double root, double y, double p) {
      return (p - kStatedAtPressure) * (1 / kStatedAtPressure) * root * y;
    });
    const auto null = IntegralOverTime<kFlowRoot, kPressureA>(
        [](double root, double p) { return (p - kStatedAtPressure) * (1 / kStatedAtPressure) * root; });
    return EffectVariant{{flow, null}, WeightsOf<kFlowArea, kFlowNull>};
  };
  return e;
}

}  // namespace hydroscope::effects
