#include "machines/die_cushion/effects/misread_pressure.h"

namespace hydroscope::effects {

/// The valve's current or the spool sensor's excitation reaches the pressure's reading by a common return or a cable beside
/// the other: p = p_measured - c y_v. Linear in c, which is small: some bar at full opening.
Effect PressureCrosstalk(const CushionGeometry&) {
  Effect e;
  e.id = "pressure_crosstalk";
  e.title = "Crosstalk of the valve on the pressure reading of chamber A";
  e.law = "p_A = p_measured - c y_v";
  e.source = "Ott 2009, Electromagnetic Compatibility Engineering, ch. 2 and 3 (cabling, grounding)";
  e.parameter = "c";
  e.unit = "Pa";
  e.min = -20e5;
  e.max = 20e5;
  e.typical = 2e5;
  e.family = {"the pressure reading is off", "der Druck wird falsch angezeigt"};
  e.confused_with = {"return_line_resistance", "tank_back_pressure", "valve_flow_curvature"};
  e.hidden_in = "Q_vn";
  e.plain =
      "The pressure reading moves with the valve though the pressure does not; look for: a common ground or supply of valve "
      "and sensor, a shield without ground, the sensor's cable beside the valve's.";
  e.german = {
      "Übersprechen des Ventils auf die Druckanzeige der Kammer A",
      "Die Druckanzeige geht mit dem Ventil, obwohl der Druck es nicht tut; zu suchen: gemeinsame Masse oder Versorgung von "
      "Ventil und Sensor, ein Schirm ohne Erdung, das Kabel des Sensors neben dem des Ventils.",
      "der Drucksensor bei drucklosem Kissen, während das Ventil hin und her gefahren wird: er muss null zeigen"};
  e.told_apart_by =
      "the pressure sensor without pressure (pump off) while the valve is driven to and fro: it must read zero";
  e.walks = true;
  e.variant = [](const auto&) {
    constexpr double kUnit = 1e5;  // Pa
    return MisreadPressure<kSpool>(kUnit, [](double y) { return y; });
  };
  return e;
}

}  // namespace hydroscope::effects
