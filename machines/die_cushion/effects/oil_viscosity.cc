#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"

namespace hydroscope::effects {
namespace {

// K; over less, 1 % per K (five times the typical size) would not stand out of what drifts by itself.
constexpr double kLeastWarming = 2.0;

}  // namespace

/// Flow gain changes with oil temperature through viscosity and density: Q_vn (1 + c (T - 40 degC)) (press
/// paper, fig. 18: nominal flow follows the oil from 26 to 32 degC).
Effect OilViscosity(const CushionGeometry&) {
  Effect e;
  e.id = "oil_viscosity";
  e.title = "Flow gain follows the oil temperature";
  e.law = "Q = (1 + c (T_oil - 40 degC)) Q";
  e.source = "press paper, fig. 18";
  e.parameter = "c";
  e.unit = "1/K";
  e.min = -0.02;
  e.max = 0.02;
  e.typical = 0.002;
  e.family = {"the flow through the valve goes with the oil temperature",
              "der Durchfluss des Ventils geht mit der Öltemperatur"};
  e.confused_with = {"Q_vn_drift", "pressure_gain_temperature"};
  e.hidden_in = "Q_vn";
  e.plain =
      "With c above 0 the valve lets through more when the oil is warm; normal to a degree. Look for: cooler or heater out of "
      "order, the wrong oil grade. No oil makes it less: with c below 0 look for a pressure or spool sensor that reads otherwise "
      "when it is warm.";
  e.german = {
      "Durchflussverstärkung folgt der Öltemperatur",
      "Mit c über 0 lässt das Ventil bei warmem Öl mehr durch; bis zu einem Grad ist das normal. Zu suchen: Kühler oder Heizung "
      "außer Betrieb, falsche Ölsorte. Kein Öl macht es weniger: bei c unter 0 einen Druck- oder Schiebersensor suchen, der "
      "warm anders zeigt.",
      "Hübe mit kaltem und mit warmem Öl, dann dasselbe in umgekehrter Folge: was der Temperatur folgt, "
      "kommt zurück, was driftet, nicht"};
  e.told_apart_by =
      "strokes with cold and with warm oil, then the same again in the other order: what follows the "
      "temperature comes back, what drifts does not";
  e.shown_by = {"strokes with cold and with warm oil, 15 K or more apart",
                "Hübe mit kaltem und mit warmem Öl, 15 K oder mehr auseinander"};
  e.channels = {kOilTemperature};
  e.least_span = OilWarmsBy(kLeastWarming);
  e.walks = true;
  e.variant = [](const auto&) {
    const auto flow = IntegralOverTime<kFlowRoot, kSpool, kOilTemperature>(
        [](double root, double y, double t) { return root * y * (t - kStatedAt); });
    const auto null = IntegralOverTime<kFlowRoot, kOilTemperature>(
        [](double root, double t) { return root * (t - kStatedAt); });
    return EffectVariant{{flow, null}, WeightsOf<kFlowArea, kFlowNull>};
  };
  return e;
}

}  // namespace hydroscope::effects
