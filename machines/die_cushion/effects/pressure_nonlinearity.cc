#include "machines/die_cushion/effects/misread_pressure.h"

namespace hydroscope::effects {

/// The reading of the pressure is bent: p = p_measured (1 - c p_measured / 100 bar). Linear in c, which is small: a share of
/// the reading at 100 bar.
Effect PressureNonlinearity(const CushionGeometry&) {
  Effect e;
  e.id = "pressure_nonlinearity";
  e.title = "Pressure sensor of chamber A that is not linear";
  e.law = "p_A = p_measured (1 - c p_measured / 100 bar)";
  e.source = "Fraden 2016, sec. 2.7 (nonlinearity of a sensor)";
  e.parameter = "c";
  e.unit = "1";
  e.min = -0.1;
  e.max = 0.1;
  e.typical = 0.01;
  e.family = {"the pressure reading is off", "der Druck wird falsch angezeigt"};
  e.confused_with = {"pressure_offset", "pressure_gain", "laminar_edge", "tank_pressure"};
  e.hidden_in = "K, Q_vn";
  e.plain =
      "The reading of the pressure is not in proportion to the pressure; look for: a sensor that has seen too much pressure, one "
      "near the end of its range, an amplifier whose table is that of another sensor.";
  e.german = {
      "Nichtlinearer Drucksensor der Kammer A",
      "Die Druckanzeige wächst nicht im Verhältnis zum Druck; zu suchen: ein Sensor, der zu viel Druck gesehen hat, einer nahe "
      "dem Ende seines Bereichs, ein Verstärker mit der Tabelle eines anderen Sensors.",
      "ein Vergleichsmanometer neben dem Sensor bei drei Drücken"};
  e.told_apart_by = "a reference gauge beside the sensor at three pressures";
  e.walks = true;
  e.variant = [](const auto&) {
    constexpr double kUnit = 1e-3, kStated = 100e5;  // 1, Pa
    return MisreadPressure<kPressureA>(kUnit, [](double p) { return p * p * (1.0 / kStated); });
  };
  return e;
}

}  // namespace hydroscope::effects
