#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"

namespace hydroscope::effects {

/// y_0 moves during the log at the rate r, y_0(t) = y_0 + r t.
Effect SpoolNullDrift(const CushionGeometry&) {
  Effect e;
  e.id = "y_0_drift";
  e.title = "Null of the spool moves during the log";
  e.law = "y_0(t) = y_0 + r t";
  e.source = "local linear trend, Harvey 1989, sec. 2.3";
  e.parameter = "r";
  e.unit = "1/s";
  e.min = -1e-3;
  e.max = 1e-3;
  e.typical = 2e-5;
  e.family = {"the null of the valve wanders", "der Nullpunkt des Ventils wandert"};
  e.confused_with = {"Q_vn_drift", "pressure_offset_drift"};
  e.hidden_in = "y_0";
  e.plain =
      "The spool position at which no oil flows moves while the log runs; look for: a transducer or "
      "amplifier that warms up, a pilot stage that wanders.";
  e.german = {
      "Nullpunkt des Schiebers wandert während der Aufzeichnung",
      "Die Schieberstellung, bei der kein Öl fließt, wandert während der Aufzeichnung; zu suchen: ein "
      "Aufnehmer oder Verstärker, der warm wird, eine wandernde Vorstufe.",
      "die Schieberstellung, bei der der Stößel stillsteht, vor und nach dem Lauf"};
  e.told_apart_by = "the spool position at which the ram stands still, before and after the run";
  e.drifting = {"y_0", "y_0"};
  e.drifts_by = "1";
  e.walks = true;
  e.variant = [](const auto&) {
    const auto null = IntegralOverTime<kFlowRoot, kTime>([](double root, double t) { return -t * root; });
    return EffectVariant{{null}, WeightsOf<kFlowArea>};
  };
  return e;
}

}  // namespace hydroscope::effects
