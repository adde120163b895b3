#include <algorithm>

#include "models/effects/effects.h"

namespace hydroscope::effects {
namespace {

double Inverse(double root) { return 1.0 / std::max(root, 300.0); }  // 300 sqrt(Pa) is 0.9 bar

}  // namespace

/// Zero error b of the pressure sensor: the true pressure is p - b, so root(p) becomes root(p) - b / (2 root(p)).
Effect PressureOffset(const CushionGeometry&) {
  Effect e;
  e.id = "pressure_offset";
  e.title = "Zero error of the pressure sensor of chamber A";
  e.law = "p_A = p_measured - b";
  e.source = "first-order expansion of eq. 2 of the press paper";
  e.parameter = "b";
  e.unit = "Pa";
  e.min = -100e5;
  e.max = 100e5;
  e.typical = 2e5;
  e.confused_with = {"orifice_leakage", "external_leakage"};
  e.hidden_in = "Q_vn, y_0";
  e.plain =
      "The pressure sensor does not read zero without pressure; look for: a drifted sensor, a wrong scale in the "
      "controller. Check it with the cushion relieved.";
  e.variant = [](const auto&) {
    const auto flow = [](const Stretch& s, double&, std::span<double> out) {
      const double *root = s[kFlowRoot], *y = s[kSpool];
      IntegrateOverTime(s, [=](int k) { return y[k] * Inverse(root[k]); }, out);
    };
    const auto null = [](const Stretch& s, double&, std::span<double> out) {
      const double* root = s[kFlowRoot];
      IntegrateOverTime(s, [=](int k) { return Inverse(root[k]); }, out);
    };
    return EffectVariant{
        {flow, null}, [](const ShapeContext& c) { return std::vector<double>{-0.5 * c.theta[0], -0.5 * c.theta[3]}; }};
  };
  return e;
}

}  // namespace hydroscope::effects
