#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"

namespace hydroscope::effects {

/// V_0 moves during the log at the relative rate d, V_0(t) = V_0 (1 + d t), t from the beginning of the log.
Effect DeadVolumeDrift(const CushionGeometry&) {
  Effect e;
  e.id = "V0_drift";
  e.title = "Dead volume moves during the log";
  e.law = "V0(t) = V0 (1 + d t)";
  e.source = "local linear trend, Harvey 1989, sec. 2.3";
  e.parameter = "d";
  e.unit = "1/s";
  e.min = -0.02;
  e.max = 0.02;
  e.typical = 5e-4;
  e.family = {"the oil volume wanders", "das Ölvolumen wandert"};
  e.confused_with = {"K_drift"};
  e.twins = {{"K_drift", 1.0}};
  e.hidden_in = "V0";
  e.plain =
      "The oil volume beside the stroke changes while the log runs; look for: a hose or accumulator that "
      "fills, a wandering zero of the position.";
  e.german = {
      "Totvolumen wandert während der Aufzeichnung",
      "Das Ölvolumen neben dem Hub ändert sich während der Aufzeichnung; zu suchen: ein Schlauch oder "
      "Speicher, der sich füllt, ein wandernder Nullpunkt des Wegs.",
      "dieselben Hübe später noch einmal bei gleicher Öltemperatur: was driftet, läuft weiter, was der "
      "Temperatur folgt, kommt zurück"};
  e.told_apart_by =
      "the same strokes once more later, at the same oil temperature: what drifts goes "
      "on, what follows the temperature comes back";
  e.drifting = {"V0", "V0"};

  e.variant = [](const auto&) {
    const auto dead_volume = IntegralOver(Of<kTime>(), Of<kPressureA>());
    return EffectVariant{{dead_volume}, WeightsOf<kDeadVolume>};
  };
  return e;
}

}  // namespace hydroscope::effects
