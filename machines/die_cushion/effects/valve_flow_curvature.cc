#include <algorithm>
#include <cmath>

#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/strokes.h"

namespace hydroscope::effects {
namespace {

constexpr double kLeastOpening = 1e-3;  // of kLogOpening

/// |y|^a; openings below 0.1 % count as 0.1 %.
double Power(double log_opening, double a) { return Exp(a * log_opening); }

}  // namespace

/// Metering edge progressive (a > 0) or degressive (a < 0): flow ~ u |u|^a, u = y_v - y_0 (Jelali and Kroll
/// 2003, sec. 4.3, curved flow gain); y_0 enters by its slope (1 + a) |y|^a.
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
  e.nonlinear = {{"exponent", "1", -0.6, 1.0}};
  e.implied = [](const ShapeContext& c) { return c.size; };
  e.family = {"the valve lets through another flow than its opening says",
              "das Ventil lässt einen anderen Durchfluss durch, als seine Öffnung sagt"};
  e.confused_with = {"tank_back_pressure", "spool_overlap"};
  e.hidden_in = "Q_vn, y_0";
  e.plain =
      "The valve's flow does not grow in proportion to its opening; look for: worn or eroded control edges, "
      "a spool with another notch shape than the data sheet says.";
  e.german = {"Gekrümmte Durchflusskennlinie der Steuerkante",
              "Der Durchfluss des Ventils wächst nicht im Verhältnis zu seiner Öffnung; zu "
              "suchen: verschlissene oder ausgewaschene Steuerkanten, ein Schieber mit "
              "anderer Kerbenform als im Datenblatt."};
  e.shown_by = kOpenings;
  e.walks = true;
  e.variant = [](const std::vector<double>& nonlinear) {
    const auto flow = IntegralOverTime<kFlowRoot, kSpool, kLogOpening>(
        [a = nonlinear[0], inverse = 1.0 / nonlinear[0]](double root, double y, double log) {
          return root * y * (Power(log, a) - 1.0) * inverse;
        });
    const auto null = IntegralOverTime<kFlowRoot, kLogOpening>(
        [a = nonlinear[0], inverse = 1.0 / nonlinear[0]](double root, double log) {
          return root * ((1.0 + a) * Power(log, a) - 1.0) * inverse;
        });
    return EffectVariant{{flow, null}, WeightsOf<kFlowArea, kFlowNull>};
  };
  e.correct = [](double a, double&, Stretch& s) {
    double* y = s[kSpool];
    for (int k = -s.before; k < s.samples + s.after; ++k)
      y[k] *= Power(Log(std::max(std::abs(y[k]), kLeastOpening)), a);
    FillLogarithms(s);
  };
  e.grid = {{-0.1}, {0.1}};
  return e;
}

}  // namespace hydroscope::effects
