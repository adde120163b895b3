#include <algorithm>

#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"

namespace hydroscope::effects {

/// The edge used for u = y_v - y_0 < 0 has another gain: flow (1 + a) there (Jelali and Kroll 2003,
/// sec. 4.3); y_0 enters by its slope. Needs strokes that use both edges.
Effect ValveFlowAsymmetry(const CushionGeometry&) {
  Effect e;
  e.id = "valve_flow_asymmetry";
  e.title = "Different gain of the two metering edges";
  e.law = "Q = (1 + a) Q for y_v < y_0";
  e.source = "Jelali and Kroll 2003, sec. 4.3";
  e.parameter = "a";
  e.unit = "1";
  e.min = -0.8;
  e.max = 2.0;
  e.typical = 0.05;
  e.family = {"the valve lets through another flow than its opening says",
              "das Ventil lässt einen anderen Durchfluss durch, als seine Öffnung sagt"};
  e.confused_with = {"spool_overlap"};
  e.hidden_in = "Q_vn";
  e.plain =
      "One control edge lets through more than the other; look for: one-sided wear or dirt of the valve.";
  e.german = {"Verschiedene Verstärkung der beiden Steuerkanten",
              "Die eine Steuerkante lässt mehr durch als die andere; zu suchen: einseitiger Verschleiß oder "
              "Schmutz des Ventils."};
  e.shown_by = {"strokes in which the valve also opens towards the supply",
                "Hübe, in denen das Ventil auch zur Versorgung öffnet"};
  e.channels = {kSupplyPressure};
  e.walks = true;
  e.variant = [](const auto&) {
    const auto flow =
        IntegralOverTime<kFlowRoot, kSpool>([](double root, double y) { return root * std::min(y, 0.0); });
    const auto null =
        IntegralOverTime<kFlowRoot, kSpool>([](double root, double y) { return y < 0 ? root : 0.0; });
    return EffectVariant{{flow, null}, WeightsOf<kFlowArea, kFlowNull>};
  };
  return e;
}

}  // namespace hydroscope::effects
