#include <algorithm>
#include <cmath>

#include "models/effects/effects.h"

namespace hydroscope::effects {
namespace {

double LogOpening(double y) { return std::log(std::max(std::abs(y), 1e-3)); }

}  // namespace

/// Metering edge progressive (a > 0) or degressive (a < 0): flow ~ u |u|^a = u (1 + a ln|u| + (a ln|u|)^2/2 + ...),
/// u = y_v - y_0 (Jelali and Kroll 2003, sec. 4.3, curved flow gain).
Effect ValveFlowCurvature(const CushionGeometry&) {
  Effect e;
  e.id = "valve_flow_curvature";
  e.title = "Curved flow gain of the metering edge";
  e.law = "Q ~ u |u|^a, u = y_v - y_0";
  e.source = "Jelali and Kroll 2003, sec. 4.3";
  e.parameter = "a";
  e.unit = "1";
  e.min = -0.6;
  e.max = 1.0;
  e.typical = 0.05;
  e.confused_with = {"tank_back_pressure", "spool_overlap"};
  e.hidden_in = "Q_vn, y_0";
  e.plain =
      "The valve's flow does not grow in proportion to its opening; look for: worn or eroded control edges, a spool with "
      "another notch shape than the data sheet says.";
  e.variant = [](const auto&) {
    const auto curve = [](const Stretch& s, double&, std::span<double> out) {
      const double *root = s[kFlowRoot], *y = s[kSpool];
      IntegrateOverTime(s, [=](int k) { return root[k] * y[k] * LogOpening(y[k]); }, out);
    };
    const auto second_order = [](const Stretch& s, double&, std::span<double> out) {
      const double *root = s[kFlowRoot], *y = s[kSpool];
      IntegrateOverTime(
          s,
          [=](int k) {
            const double log = LogOpening(y[k]);
            return root[k] * y[k] * log * log;
          },
          out);
    };
    const auto null = [](const Stretch& s, double&, std::span<double> out) {
      const double *root = s[kFlowRoot], *y = s[kSpool];
      IntegrateOverTime(s, [=](int k) { return root[k] * LogOpening(y[k]); }, out);
    };
    return EffectVariant{{curve, second_order, null}, [](const ShapeContext& c) {
                           return std::vector<double>{c.theta[0], 0.5 * c.size * c.theta[0], c.theta[3]};
                         }};
  };
  return e;
}

}  // namespace hydroscope::effects
