#include "machines/die_cushion/effects/misread_pressure.h"

namespace hydroscope::effects {
namespace {

constexpr double kLeastSensorWarming = 2.0;  // K; over less, the largest size changes a reading by 0.2 %

}  // namespace

/// The pressure sensor reads 1 + g (T - 40 degC) times the pressure: its span follows the temperature, as data sheets of
/// transmitters state it (0.01 to 0.03 % per K). Linear in g, which is small: g ΔT stays within 2 %.
Effect PressureGainTemperature(const CushionGeometry&) {
  Effect e;
  e.id = "pressure_gain_temperature";
  e.title = "Scale of the pressure sensor of chamber A follows the temperature";
  e.law = "p_A = p_measured (1 - g (T_oil - 40 degC))";
  e.source = "eq. 1-2 of the press paper with the pressure scaled";
  e.parameter = "g";
  e.unit = "1/K";
  e.min = -0.001;
  e.max = 0.001;
  e.typical = 0.0003;
  e.family = {"the pressure reading goes with the temperature", "die Druckanzeige geht mit der Temperatur"};
  e.confused_with = {"oil_viscosity", "pressure_offset_drift", "pressure_offset_temperature"};
  e.twins = {{"oil_viscosity"}};
  e.hidden_in = "Q_vn";
  e.plain =
      "The pressure sensor reads too much or too little in proportion as it warms; look for: a sensor beside hot oil, one "
      "outside its compensated range.";
  e.german = {
      "Skala des Drucksensors der Kammer A folgt der Temperatur",
      "Der Drucksensor zeigt mit der Erwärmung im Verhältnis zu viel oder zu wenig; zu suchen: ein Sensor an heißem Öl, "
      "einer außerhalb seines kompensierten Bereichs.",
      "ein Vergleichsmanometer neben dem Sensor, bei kaltem und bei warmem Öl unter demselben Druck: Hübe allein halten es für "
      "einen Durchfluss, der mit dem Öl geht"};
  e.told_apart_by =
      "a reference gauge beside the sensor, with cold and with warm oil at the same pressure: strokes alone take it for a flow "
      "that goes with the oil";
  e.channels = {kOilTemperature};
  e.least_span = OilWarmsBy(kLeastSensorWarming);
  e.walks = true;
  e.variant = [](const auto&) {
    constexpr double kUnit = 1e-4;  // 1/K
    return MisreadPressure<kPressureA, kOilTemperature>(
        kUnit, [](double p, double t) { return p * (t - kStatedAt); });
  };
  return e;
}

}  // namespace hydroscope::effects
