#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"

namespace hydroscope::effects {

/// The null of the spool follows the pressure, as data sheets of servo valves state it (2 % of the stroke over the supply
/// pressure): y_0 + r p_A. A spool reading into which the pressure sensor talks looks the same.
Effect SpoolNullPressure(const CushionGeometry&) {
  Effect e;
  e.id = "spool_null_pressure";
  e.title = "Null of the spool follows the pressure";
  e.law = "y_0(p) = y_0 + r p_A";
  e.source = "Merritt 1967, ch. 7 (servo valves)";
  e.parameter = "r";
  e.unit = "1/Pa";
  e.min = -4e-9;
  e.max = 4e-9;
  e.typical = 2e-10;
  e.family = {"the null of the valve goes with the pressure", "der Nullpunkt des Ventils geht mit dem Druck"};
  e.confused_with = {"pressure_offset", "tank_pressure", "external_leakage", "internal_leakage"};
  e.hidden_in = "y_0";
  e.plain =
      "The spool position at which no oil flows moves with the pressure; normal to a degree (2 % over the supply pressure). Look "
      "for: a valve body strained by its screws, a worn edge, the cables of pressure and spool sensor side by side.";
  e.german = {
      "Nullpunkt des Schiebers folgt dem Druck",
      "Die Schieberstellung, bei der kein Öl fließt, wandert mit dem Druck; bis zu einem Grad ist das normal (2 % über den "
      "Versorgungsdruck). Zu suchen: ein durch seine Schrauben verspanntes Ventilgehäuse, eine verschlissene Kante, die Kabel "
      "von Druck- und Schiebersensor nebeneinander.",
      "die Schieberstellung, bei der der Stößel stillsteht, bei kleinem und bei großem Druck"};
  e.told_apart_by = "the spool position at which the ram stands still, at a low and at a high pressure";
  e.walks = true;
  e.variant = [](const auto&) {
    const auto null =
        IntegralOverTime<kFlowRoot, kPressureA>([](double root, double p) { return -p * root; });
    return EffectVariant{{null}, WeightsOf<kFlowArea>};
  };
  return e;
}

}  // namespace hydroscope::effects
