#include <algorithm>
#include <cmath>

#include "core/parallel/wide.h"
#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/strokes.h"

namespace hydroscope::effects {
namespace {

constexpr double kNearlyClosed = 1e-3;

/// The flow through a column of oil before an edge of opening y, per k: x dq/dt = |dp| - (q / y)^2, x = L k.
struct ColumnFlow {
  double step;  ///< period / x
  double q;     ///< of the last sample, without sign
};

/// Goes on from sample 0 to `count` <= kChunk; `lag` is how far q is behind the flow without a column, from
/// sample 1 on. By the trapezium rule, q^2 taken as the product of old and new value; where the column
/// settles within a sample it follows a ramp, by its time constant late. Only a column that has not settled
/// waits for the sample before.
HYDROSCOPE_WIDE void AdvanceColumn(ColumnFlow& column, const double* root, const double* y, int count,
                                   double* lag) {
  double opening[kChunk + 1], steady[kChunk + 1], loss[kChunk], settled[kChunk];
  for (int k = 0; k <= count; ++k) {
    opening[k] = 1.0 / std::max(std::abs(y[k]), kNearlyClosed);
    steady[k] = y[k] * root[k];
  }
  int moving = 0;
  for (int k = 0; k < count; ++k) {
    loss[k] = column.step * opening[k] * opening[k + 1];
    settled[k] = loss[k] * std::abs(steady[k + 1]);  // half the period over the time constant
    lag[k] = (steady[k + 1] - steady[k]) * (0.5 / std::max(settled[k], 0.5));
    moving += settled[k] < 1.0;
  }
  if (moving > 0) {
    for (int k = 0; k < count; ++k) {
      const double drop = 0.5 * (root[k] * std::abs(root[k]) + root[k + 1] * std::abs(root[k + 1]));
      const double next = (column.q + column.step * drop) / (1.0 + loss[k] * column.q);
      const bool swings = settled[k] < 1.0 && next >= 0.0;
      column.q = swings ? next : std::abs(steady[k + 1] - lag[k]);
      if (swings) lag[k] = steady[k + 1] - std::copysign(column.q, steady[k + 1]);
    }
  }
  column.q = std::abs(steady[count] - lag[count - 1]);
}

/// Increments of the lag per x, on a column in motion since as long as the signals are known.
void IntegrateLag(const Stretch& s, double x, std::span<double> out) {
  const double *root = s[kFlowRoot], *y = s[kSpool];
  ColumnFlow column{s.period / x, std::abs(root[-s.before] * y[-s.before])};
  double lag[kChunk];
  for (int k = -s.before; k < 0; k += kChunk)
    AdvanceColumn(column, root + k, y + k, std::min(kChunk, -k), lag);
  const double scale = 0.5 * s.period / x;
  double left = y[0] * root[0] - std::copysign(column.q, y[0] * root[0]);
  for (int first = 0; first + 1 < s.samples; first += kChunk) {
    const int count = std::min(kChunk, s.samples - 1 - first);
    AdvanceColumn(column, root + first, y + first, count, lag);
    for (int k = 0; k < count; ++k) {
      out[first + k] = scale * (left + lag[k]);
      left = lag[k];
    }
  }
}

}  // namespace

/// Oil column between cylinder and valve: the valve sees p_A - L dQ/dt, so the flow follows k y_v root(dp)
/// late, k = -theta1 (lumped inertance L = rho l / A, Merritt 1967, sec. 3-6).
Effect LineInertance(const CushionGeometry&) {
  Effect e;
  e.id = "line_inertance";
  e.title = "Inertia of the oil column between cylinder and valve";
  e.law = "p_valve = p_A - L dQ/dt";
  e.source = "Merritt 1967, sec. 3-6 (lumped line)";
  e.parameter = "L";
  e.unit = "kg/m4";
  e.max = 1e10;
  e.typical = 5e6;
  e.nonlinear = {{"x", "s sqrt(Pa)", 0.1, 3000.0}};
  e.implied = [](const ShapeContext& c) { return -c.size * c.theta[0]; };
  e.family = {"the oil column before the valve takes time to follow",
              "die Ölsäule vor dem Ventil folgt mit Verzug"};
  e.confused_with = {"spool_signal_delay", "pressure_signal_delay", "position_signal_delay"};
  e.hidden_in = "V0";
  e.plain =
      "A long or narrow line between cylinder and valve makes the oil column swing; look for: a long hose "
      "fitted, a throttled line.";
  e.german = {"Trägheit der Ölsäule zwischen Zylinder und Ventil",
              "Eine lange oder enge Leitung zwischen Zylinder und Ventil lässt die Ölsäule schwingen; zu "
              "suchen: ein langer Schlauch, eine gedrosselte Leitung."};
  e.shown_by = kSteps;
  e.separations = {{"spool_signal_delay", kSteps}};
  e.variant = [](const std::vector<double>& nonlinear) {
    const auto flow = [x = nonlinear[0]](const Stretch& s, double&, std::span<double> out) {
      IntegrateLag(s, x, out);
    };
    return EffectVariant{{flow},
                         [](const ShapeContext& c) { return std::vector<double>{c.theta[0] * c.theta[0]}; }};
  };
  e.grid = {{8.0}};
  return e;
}

}  // namespace hydroscope::effects
