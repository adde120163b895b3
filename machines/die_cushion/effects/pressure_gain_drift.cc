#include "machines/die_cushion/effects/misread_pressure.h"

namespace hydroscope::effects {

/// The scale of the pressure sensor moves during the log at the relative rate g: the true pressure is p (1 - g t), t from the
/// beginning of the log, at which the scale is right.
Effect PressureGainDrift(const CushionGeometry&) {
  Effect e;
  e.id = "pressure_gain_drift";
  e.title = "Scale of the pressure sensor of chamber A moves during the log";
  e.law = "p_A = p_measured (1 - g t)";
  e.source = "eq. 1-2 of the press paper with the pressure scaled";
  e.parameter = "g";
  e.unit = "1/s";
  e.min = -5e-3;
  e.max = 5e-3;
  e.typical = 2e-4;
  e.family = {"the pressure reading wanders", "die Druckanzeige wandert"};
  e.confused_with = {"Q_vn_drift", "pressure_offset_drift", "pressure_gain_temperature"};
  e.twins = {{"Q_vn_drift"}};
  e.hidden_in = "Q_vn";
  e.plain =
      "The pressure sensor reads more or less in proportion as the log goes on; look for: an amplifier that warms up, a supply "
      "voltage that sinks, a sensor that has seen too much pressure.";
  e.german = {
      "Skala des Drucksensors der Kammer A wandert während der Aufzeichnung",
      "Der Drucksensor zeigt im Verhältnis mehr oder weniger, je länger die Aufzeichnung dauert; zu suchen: ein Verstärker, der "
      "warm wird, eine sinkende Versorgungsspannung, ein Sensor, der zu viel Druck gesehen hat.",
      "ein Vergleichsmanometer neben dem Sensor, vor und nach dem Lauf unter demselben Druck: Hübe allein halten es für einen "
      "Durchfluss, der wandert"};
  e.told_apart_by =
      "a reference gauge beside the sensor, before and after the run at the same pressure: "
      "strokes alone take it for a flow that wanders";
  e.drifting = {"the scale of the pressure sensor", "die Skala des Drucksensors"};
  e.walks = true;
  e.variant = [](const auto&) {
    constexpr double kUnit = 1e-5;  // 1/s
    return MisreadPressure<kPressureA, kTime>(kUnit, [](double p, double t) { return p * t; });
  };
  return e;
}

}  // namespace hydroscope::effects
