#include "machines/die_cushion/effects/misread_pressure.h"

namespace hydroscope::effects {

/// The position sensor's signal reaches the pressure's reading by a common return or supply: p = p_measured - c z. Linear in
/// c, which is small: some bar over the stroke. No flow through the valve explains it, for it goes with the speed of the ram
/// and not with the opening.
Effect PressurePositionCrosstalk(const CushionGeometry&) {
  Effect e;
  e.id = "pressure_position_crosstalk";
  e.title = "Crosstalk of the position on the pressure reading of chamber A";
  e.law = "p_A = p_measured - c z";
  e.source = "Ott 2009, Electromagnetic Compatibility Engineering, ch. 2 and 3 (cabling, grounding)";
  e.parameter = "c";
  e.unit = "Pa/m";
  e.min = -1e7;
  e.max = 1e7;
  e.typical = 1e6;
  e.family = {"the pressure reading is off", "der Druck wird falsch angezeigt"};
  e.confused_with = {"pressure_crosstalk", "position_nonlinearity", "position_dependent_leakage"};
  e.hidden_in = "V0";
  e.plain =
      "The pressure reading moves with the position though the pressure does not; look for: a common ground or supply of both "
      "sensors, a cable that is bent as the ram moves.";
  e.german = {
      "Übersprechen der Position auf die Druckanzeige der Kammer A",
      "Die Druckanzeige geht mit der Position, obwohl der Druck es nicht tut; zu suchen: gemeinsame Masse oder Versorgung "
      "beider Sensoren, ein Kabel, das der Stößel biegt.",
      "der Drucksensor bei drucklosem Kissen, während der Stößel es langsam hinab und hinauf fährt: er muss null zeigen"};
  e.told_apart_by =
      "the pressure sensor without pressure while the ram moves the cushion slowly down and up: it must read zero";
  e.walks = true;
  e.variant = [](const auto&) {
    constexpr double kUnit = 1e5;  // Pa/m
    return MisreadPressure<kPosition>(kUnit, [](double z) { return z; });
  };
  return e;
}

}  // namespace hydroscope::effects
