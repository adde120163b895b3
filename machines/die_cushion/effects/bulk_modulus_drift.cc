#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"

namespace hydroscope::effects {

/// K moves during the log at the relative rate d: its reciprocal is (1 - d t) / K, t from the beginning
/// of the log, where K is stated.
Effect BulkModulusDrift(const CushionGeometry&) {
  Effect e;
  e.id = "K_drift";
  e.title = "Bulk modulus moves during the log";
  e.law = "1/K(t) = (1 - d t) / K";
  e.source = "local linear trend, Harvey 1989, sec. 2.3";
  e.parameter = "d";
  e.unit = "1/s";
  e.min = -0.02;
  e.max = 0.02;
  e.typical = 2e-4;
  e.family = {"the stiffness of the oil column wanders", "die Steifigkeit der Ölsäule wandert"};
  e.confused_with = {"V0_drift"};
  e.hidden_in = "K";
  e.plain =
      "The oil column gets softer or stiffer while the log runs; look for: air "
      "drawn in or coming out, oil that warms.";
  e.german = {
      "Kompressionsmodul wandert während der Aufzeichnung",
      "Die Ölsäule wird während der Aufzeichnung weicher oder steifer; zu suchen: Luft, die angesaugt "
      "wird oder ausgast, Öl, das warm wird.",
      "dieselben Hübe später noch einmal bei gleicher Öltemperatur: was driftet, läuft weiter, was der "
      "Temperatur folgt, kommt zurück"};
  e.told_apart_by =
      "the same strokes once more later, at the same oil temperature: what drifts goes "
      "on, what follows the temperature comes back";
  e.drifting = {"K", "K"};

  e.variant = [](const auto&) {
    const auto dead_volume = IntegralOver(Of<kTime>([](double t) { return -t; }), Of<kPressureA>());
    const auto stroke_volume =
        IntegralOver(Of<kPosition, kTime>([](double z, double t) { return -t * z; }), Of<kPressureA>());
    return EffectVariant{{dead_volume, stroke_volume}, WeightsOf<kDeadVolume, kStrokeVolume>};
  };
  return e;
}

}  // namespace hydroscope::effects
