#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "models/effects/effects.h"

namespace hydroscope::effects {

/// Dead band around the null: the edge opens only once |y_v| exceeds d (Merritt 1967, sec. 5-3, closed-centre valve).
/// Fully open the dead band looks like a shifted null, so it shows only where the spool passes the band.
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
  e.confused_with = {"valve_flow_curvature", "orifice_leakage"};
  e.hidden_in = "y_0";
  e.plain =
      "The valve has to move a little before it lets oil through; look for: a spool with overlap in place of a zero-lap "
      "one, the wrong valve after a repair, a mechanical null far off.";
  for (double band : {0.02, 0.04, 0.08}) {
    e.shapes.push_back({{static_cast<int>(e.columns.size())},
                        [](const ShapeContext& c) { return std::vector<double>{c.theta[0]}; },
                        {band}});
    e.columns.push_back({fmt::format("spool_overlap_{:g}", band), [band](const Stretch& s, double&, std::span<double> out) {
                           const double *root = s[kFlowRoot], *y = s[kSpool];
                           IntegrateOverTime(
                               s, [=](int k) { return -root[k] * std::clamp(y[k], -band, band) / band; }, out);
                         }});
  }
  return e;
}

}  // namespace hydroscope::effects
