#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"

namespace hydroscope::effects {

/// Q_vn moves during the log at the relative rate d, Q_vn(t) = Q_vn (1 + d t), t from the beginning of the log.
Effect FlowGainDrift(const CushionGeometry&) {
  Effect e;
  e.id = "Q_vn_drift";
  e.title = "Flow gain of the valve moves during the log";
  e.law = "Q_vn(t) = Q_vn (1 + d t)";
  e.source = "local linear trend, Harvey 1989, sec. 2.3";
  e.parameter = "d";
  e.unit = "1/s";
  e.min = -5e-3;
  e.max = 5e-3;
  e.typical = 1e-4;
  e.family = {"the flow through the valve wanders", "der Durchfluss des Ventils wandert"};
  e.confused_with = {"oil_viscosity", "y_0_drift"};
  e.hidden_in = "Q_vn";
  e.plain =
      "The valve lets through more or less as the log goes on; look for: oil that "
      "warms, dirt on the edge, a spool that sticks.";
  e.german = {
      "Durchflussverstärkung des Ventils wandert während der Aufzeichnung",
      "Das Ventil lässt im Lauf der Aufzeichnung mehr oder weniger durch; zu suchen: Öl, das warm wird, "
      "Schmutz an der Kante, ein klemmender Schieber.",
      "Hübe bei lange gleicher Öltemperatur, dann Hübe mit kaltem und mit warmem Öl"};
  e.told_apart_by =
      "strokes with the oil at one temperature for a long time, then strokes with cold and with warm oil";
  e.drifting = {"Q_vn", "Q_vn"};
  e.walks = true;
  e.variant = [](const auto&) {
    const auto flow = IntegralOverTime<kFlowRoot, kSpool, kTime>(
        [](double root, double y, double t) { return t * root * y; });
    const auto null = IntegralOverTime<kFlowRoot, kTime>([](double root, double t) { return t * root; });
    return EffectVariant{{flow, null}, WeightsOf<kFlowArea, kFlowNull>};
  };
  return e;
}

}  // namespace hydroscope::effects
