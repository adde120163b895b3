#include <algorithm>

#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"

namespace hydroscope::effects {

/// Dead band around the null: the edge opens only once |y_v| exceeds d (Merritt 1967, sec. 5-3, closed-centre
/// valve). Fully open the dead band looks like a shifted null, so it shows only where the spool passes the band.
Effect SpoolOverlap(const CushionGeometry&) {
  Effect e;
  e.id = "spool_overlap";
  e.title = "Overlap of the spool";
  e.law = "y_eff = sign(y_v) max(|y_v| - d, 0)";
  e.source = "Merritt 1967, sec. 5-3 (closed-centre valve)";
  e.parameter = "d";
  e.unit = "1";
  e.max = 0.2;
  e.typical = 0.02;
  e.nonlinear = {{"band", "1", 0.002, 0.2}};
  e.implied = [](const ShapeContext& c) { return c.size; };
  e.family = {"the valve lets through another flow than its opening says",
              "das Ventil lässt einen anderen Durchfluss durch, als seine Öffnung sagt"};
  e.confused_with = {"valve_flow_curvature", "orifice_leakage"};
  e.hidden_in = "y_0";
  e.plain =
      "The valve has to move a little before it lets oil through; look for: a spool with overlap in place of "
      "a zero-lap one, the wrong valve after a repair, a mechanical null far off.";
  e.german = {"Überdeckung des Schiebers",
              "Das Ventil muss sich ein wenig bewegen, bevor es Öl durchlässt; zu suchen: ein Schieber mit "
              "Überdeckung anstelle eines mit Nullüberdeckung, das falsche Ventil nach einer Reparatur, ein "
              "weit verstellter mechanischer Nullpunkt."};
  e.shown_by = {"slow strokes with the spool near its null as well as fast ones",
                "langsame Hübe mit dem Schieber nahe seinem Nullpunkt und schnelle"};
  e.walks = true;
  e.variant = [](const std::vector<double>& nonlinear) {
    const auto flow = IntegralOverTime<kFlowRoot, kSpool>(
        [band = nonlinear[0], scale = -1.0 / nonlinear[0]](double root, double y) {
          return scale * root * std::clamp(y, -band, band);
        });
    return EffectVariant{{flow}, WeightsOf<kFlowArea>};
  };
  e.grid = {{0.02}, {0.04}, {0.08}};
  return e;
}

}  // namespace hydroscope::effects
