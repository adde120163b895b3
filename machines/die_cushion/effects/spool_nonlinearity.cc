
#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/strokes.h"

namespace hydroscope::effects {

/// The reading of the spool bends from a straight line: y = y_v + c y_v |y_v|^(n - 1). Where the oil leaves by one edge, a choked
/// return line and a curved edge let through less or more with the opening as well, root(dp) beside it: what tells these apart is
/// the bend's shape alone, which nobody knows of a sensor. The null is of the true opening and stays.
Effect SpoolNonlinearity(const CushionGeometry&) {
  Effect e;
  e.id = "spool_nonlinearity";
  e.title = "Spool sensor that is not linear";
  e.law = "y_v = y_measured + c y_measured |y_measured|^(n - 1)";
  e.source = "Fraden 2016, sec. 2.7 (nonlinearity of a sensor)";
  e.parameter = "c";
  e.unit = "1";
  e.min = -0.3;
  e.max = 0.3;
  e.typical = 0.05;
  e.nonlinear = {{"n", "1", 1.2, 8.0}};
  e.family = {"the valve lets through another flow than its opening says",
              "das Ventil lässt einen anderen Durchfluss durch, als seine Öffnung sagt"};
  e.confused_with = {"tank_back_pressure", "valve_flow_curvature"};
  e.twins = {{"tank_back_pressure"}, {"valve_flow_curvature"}};
  e.hidden_in = "Q_vn, y_0";
  e.plain =
      "The reading of the spool position is not in proportion to the opening; look for: the valve's position "
      "transducer or its amplifier set up wrongly, a transducer driven near the end of its range.";
  e.german = {
      "Nichtlinearer Schiebersensor",
      "Die gemessene Schieberstellung wächst nicht im Verhältnis zur Öffnung; zu suchen: "
      "ein falsch eingestellter Wegaufnehmer des Ventils oder dessen Verstärker, ein Aufnehmer nahe dem Ende "
      "seines Bereichs.",
      "ein Manometer gleich hinter dem Ventil bei einem schnellen Hub: bleibt es beim Tankdruck, so liegt es an "
      "Sensor oder Kante; diese trennt die Kennlinie des Ventils auf dem Prüfstand"};
  e.told_apart_by =
      "a pressure gauge right behind the valve during a fast stroke: where it stays at the tank's pressure, sensor or edge is "
      "the cause; the valve's flow curve on a test bench tells these two apart";
  e.shown_by = kOpenings;
  e.walks = true;
  e.variant = [](const std::vector<double>& nonlinear) {
    const auto bent = IntegralOverTime<kFlowRoot, kSpool, kLogOpening>(
        [power = nonlinear[0] - 1](double root, double y, double log) {
          return root * y * Exp(power * log);
        });
    return EffectVariant{{bent}, WeightsOf<kFlowArea>};
  };
  e.grid = {{1.5}, {3.0}};
  return e;
}

}  // namespace hydroscope::effects
