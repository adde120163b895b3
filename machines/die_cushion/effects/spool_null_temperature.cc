#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"

namespace hydroscope::effects {
namespace {

constexpr double kLeastNullWarming =
    2.0;  // K; over less, five times the typical size moves the null by 0.1 % of the stroke

}  // namespace

/// The null of the spool follows the oil temperature, as data sheets of servo valves state it (2 to 4 % of the stroke over
/// 40 K): y_0 + r (T - 40 degC).
Effect SpoolNullTemperature(const CushionGeometry&) {
  Effect e;
  e.id = "spool_null_temperature";
  e.title = "Null of the spool follows the temperature";
  e.law = "y_0(T) = y_0 + r (T_oil - 40 degC)";
  e.source = "Merritt 1967, ch. 7 (servo valves)";
  e.parameter = "r";
  e.unit = "1/K";
  e.min = -0.005;
  e.max = 0.005;
  e.typical = 1e-4;
  e.family = {"the null of the valve goes with the temperature",
              "der Nullpunkt des Ventils geht mit der Temperatur"};
  e.confused_with = {"y_0_drift", "oil_viscosity", "pressure_offset_temperature"};
  e.hidden_in = "y_0";
  e.plain =
      "The spool position at which no oil flows moves with the oil's temperature; normal to a degree (2 % over 40 K). Look "
      "for: a pilot stage or a transducer that suffers from the heat.";
  e.german = {
      "Nullpunkt des Schiebers folgt der Temperatur",
      "Die Schieberstellung, bei der kein Öl fließt, wandert mit der Öltemperatur; bis zu einem Grad ist das normal (2 % über "
      "40 K). Zu suchen: eine Vorstufe oder ein Aufnehmer, der unter der Wärme leidet.",
      "die Schieberstellung, bei der der Stößel stillsteht, mit kaltem und mit warmem Öl"};
  e.told_apart_by = "the spool position at which the ram stands still, with cold and with warm oil";
  e.channels = {kOilTemperature};
  e.least_span = OilWarmsBy(kLeastNullWarming);
  e.walks = true;
  e.variant = [](const auto&) {
    const auto null = IntegralOverTime<kFlowRoot, kOilTemperature>(
        [](double root, double t) { return -(t - kStatedAt) * root; });
    return EffectVariant{{null}, WeightsOf<kFlowArea>};
  };
  return e;
}

}  // namespace hydroscope::effects
