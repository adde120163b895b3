#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"

namespace hydroscope::effects {

/// The reading of the position is bowed between the ends of the stroke s: z = z_m + c z_m (1 - z_m / s). The balance then errs
/// by the speed of the ram, with one sign in the upper half of the stroke and the other in the lower half.
Effect PositionNonlinearity(const CushionGeometry& geometry) {
  Effect e;
  e.id = "position_nonlinearity";
  e.title = "Position sensor that is not linear";
  e.law = "z = z_measured + c z_measured (1 - z_measured / stroke)";
  e.source = "Fraden 2016, sec. 2.7 (nonlinearity of a sensor)";
  e.parameter = "c";
  e.unit = "1";
  e.min = -0.1;
  e.max = 0.1;
  e.typical = 0.005;
  e.family = {"the position reading is bent", "die Weganzeige ist krumm"};
  e.confused_with = {"pressure_position_crosstalk", "position_dependent_leakage"};
  e.hidden_in = "Q_vn, V0";
  e.plain =
      "The reading of the position is not in proportion to the travel; look for: a draw wire or lever that pulls at an angle, a "
      "transducer that was exchanged without its table, a magnet near iron.";
  e.german = {
      "Nichtlinearer Wegsensor",
      "Die Weganzeige wächst nicht im Verhältnis zum Weg; zu suchen: ein Seilzug oder Hebel, der schräg zieht, ein Aufnehmer, "
      "der ohne seine Tabelle getauscht wurde, ein Magnet nahe Eisen.",
      "Endmaße oder ein Maßstab neben dem Wegsensor, an den Enden und in der Mitte des Hubs"};
  e.told_apart_by =
      "gauge blocks or a scale beside the position sensor, at the ends and in the middle of the stroke";
  e.walks = true;
  e.variant = [area = geometry.piston_area, stroke = geometry.stroke](const auto&) {
    const auto bow = [stroke](double z) { return z * (1.0 - z / stroke); };
    const auto travel = ChangeOf<kPosition>([=](double z) { return -area * bow(z); });
    const auto stroke_volume = IntegralOver(Of<kPosition>(bow), Of<kPressureA>());
    return EffectVariant{{travel, stroke_volume}, [](const ShapeContext& c) {
                           return std::vector<double>{1.0, c.theta[kStrokeVolume]};
                         }};
  };
  return e;
}

}  // namespace hydroscope::effects
