#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/strokes.h"

namespace hydroscope::effects {

/// The null of the spool follows the pressure, as data sheets of servo valves state it of the supply's (up to 2 % of the stroke over
/// 70 bar): y_0 + r (p_A - 100 bar).
Effect SpoolNullPressure(const CushionGeometry&) {
  Effect e;
  e.id = "spool_null_pressure";
  e.title = "Null of the spool follows the pressure";
  e.law = "y_0(p) = y_0 + r (p_A - 100 bar)";
  e.source = "Merritt 1967, ch. 7 (servo valves)";
  e.parameter = "r";
  e.unit = "1/Pa";
  e.min = -5e-9;
  e.max = 5e-9;
  e.typical = 2e-10;
  e.family = {"the null of the valve goes with the pressure", "der Nullpunkt des Ventils geht mit dem Druck"};
  e.confused_with = {"external_leakage", "internal_leakage", "pressure_nonlinearity"};
  e.hidden_in = "y_0, Q_vn";
  e.plain =
      "The spool position at which no oil flows moves with the pressure; normal to a degree (data sheets allow 2 % over 70 bar of "
      "supply). Look for: a valve body bolted down unevenly, a worn pilot stage, a transducer that feels the pressure.";
  e.german = {
      "Nullpunkt des Schiebers folgt dem Druck",
      "Die Schieberstellung, bei der kein Öl fließt, wandert mit dem Druck; bis zu einem Grad ist das normal (Datenblätter: 2 % "
      "über 70 bar Versorgung). Zu suchen: ein ungleich verschraubtes Ventilgehäuse, eine verschlissene Vorstufe, ein Aufnehmer, "
      "der den Druck spürt.",
      "der Druckabfall der Kammer bei abgesperrtem Ventil: ein Leck senkt ihn, ein Nullpunkt nicht"};
  e.told_apart_by =
      "the pressure of the chamber with the valve shut off: a leak lets it fall, a null does not";
  e.shown_by = kPressureSteps;
  e.separations = {{"external_leakage", kPressureSteps}, {"internal_leakage", kPressureSteps}};
  e.walks = true;
  e.variant = [](const auto&) {
    const auto null = IntegralOverTime<kFlowRoot, kPressureA>(
        [](double root, double p) { return -(p - kStatedAtPressure) * root; });
    return EffectVariant{{null}, WeightsOf<kFlowArea>};
  };
  return e;
}

}  // namespace hydroscope::effects
