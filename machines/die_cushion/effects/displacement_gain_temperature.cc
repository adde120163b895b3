#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"

namespace hydroscope::effects {
namespace {

constexpr double kLeastScaleWarming = 2.0;  // K; over less, the largest size changes a reading by 0.1 %

}  // namespace

/// The span of the spool or the position sensor follows the temperature, as data sheets of transducers state it (0.005 to
/// 0.05 % per K): the spool's reads 1 + g (T - 40 degC) times the opening, or the position's 1 - g (T - 40 degC) times the
/// position. To the balance either is a flow gain that goes with the oil.
Effect DisplacementGainTemperature(const CushionGeometry&) {
  Effect e;
  e.id = "displacement_gain_temperature";
  e.title = "Scale of the spool or the position sensor follows the temperature";
  e.law = "y_v = y_measured (1 - g (T_oil - 40 degC)), or z = z_measured (1 + g (T_oil - 40 degC))";
  e.source = "eq. 1-2 of the press paper with the displacement scaled";
  e.parameter = "g";
  e.unit = "1/K";
  e.min = -0.0005;
  e.max = 0.0005;
  e.typical = 0.0002;
  e.family = {"a displacement reading goes with the temperature", "eine Weganzeige geht mit der Temperatur"};
  e.confused_with = {"oil_viscosity", "pressure_gain_temperature", "Q_vn_drift"};
  e.twins = {{"oil_viscosity"}};
  e.hidden_in = "Q_vn";
  e.plain =
      "The spool or the position sensor reads too much or too little in proportion as it warms; look for: a transducer outside "
      "its compensated range, electronics beside hot oil.";
  e.german = {
      "Skala des Schieber- oder des Positionssensors folgt der Temperatur",
      "Der Schieber- oder der Positionssensor zeigt mit der Erwärmung im Verhältnis zu viel oder zu wenig; zu suchen: ein "
      "Aufnehmer außerhalb seines kompensierten Bereichs, Elektronik an heißem Öl.",
      "ein Endmaß am Positionssensor und der volle Schieberweg, mit kaltem und mit warmem Öl: Hübe allein halten es für einen "
      "Durchfluss, der mit dem Öl geht"};
  e.told_apart_by =
      "a gauge block at the position sensor and the full travel of the spool, with cold and with warm oil: strokes alone take it "
      "for a flow that goes with the oil";
  e.channels = {kOilTemperature};
  e.least_span = OilWarmsBy(kLeastScaleWarming);
  e.walks = true;
  e.variant = [](const auto&) {
    const auto flow = IntegralOverTime<kFlowRoot, kSpool, kOilTemperature>(
        [](double root, double y, double t) { return -root * y * (t - kStatedAt); });
    return EffectVariant{{flow}, WeightsOf<kFlowArea>};
  };
  return e;
}

}  // namespace hydroscope::effects
