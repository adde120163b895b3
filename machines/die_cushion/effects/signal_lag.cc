#include <algorithm>
#include <cmath>

#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"

namespace hydroscope::effects {
namespace {

constexpr double kLeastRootOfLag = 447.0;  ///< sqrt(Pa), below which the root's curvature is not taken

/// Half the curvature of root(p) over p times the square of the pressure's rate.
double Curvature(double root, double rate) {
  const double r = std::max(std::abs(root), kLeastRootOfLag);
  return -0.125 * rate * rate / (r * r * r);
}

}  // namespace

/// All signals follow through the same first-order lag, as of one filter setting for all inputs. A linear
/// balance would not notice; of products it leaves, with S = tau^2, S a' b' (from lag(a b) - lag(a) lag(b)),
/// and of the root S p'^2 / 2 times its curvature, to second order in tau.
Effect SignalLag(const CushionGeometry&) {
  Effect e;
  e.id = "signal_lag";
  e.title = "All signals lag alike (first-order filter)";
  e.law = "x = x_measured + tau dx_measured/dt for p_A, z and y_v, S = tau^2";
  e.source = "eq. 1-2 of the press paper with all signals filtered, to second order";
  e.parameter = "S";
  e.unit = "s2";
  e.max = 1e-2;
  e.typical = 2.5e-5;
  e.nonlinear = {{"lag", "s", 0.001, 0.1}};
  e.implied = [](const ShapeContext& c) { return std::sqrt(std::max(c.size, 0.0)); };
  e.family = {"the signals are smoothed before they are recorded",
              "die Signale werden geglättet, bevor sie aufgezeichnet werden"};
  e.confused_with = {"pressure_signal_lag", "spool_signal_lag", "position_signal_lag"};
  e.hidden_in = "K, V0";
  e.plain =
      "All signals are smoothed before they are recorded; look for: one filter time set for all inputs of "
      "the controller, a recorder that averages.";
  e.german = {
      "Alle Signale hinken gleich nach (Filter erster Ordnung)",
      "Alle Signale werden geglättet, bevor sie aufgezeichnet werden; zu suchen: eine Filterzeit, die "
      "für alle Eingänge der Steuerung gesetzt ist, ein Schreiber, der mittelt.",
      "die Filtereinstellungen der Eingänge, oder dieselben Hübe ohne Filter aufgezeichnet"};
  e.told_apart_by = "the filter settings of the inputs, or the same strokes recorded without filters";
  e.variant = [](const std::vector<double>&) {
    const auto flow = [](const Stretch& s, double&, std::span<double> out) {
      const double *root = s[kFlowRoot], *y = s[kSpool], *rate = s[kPressureRate];
      const auto slope = [=](int k) {
        const double side = y[k] >= 0 ? 0.5 : -0.5;
        return side * rate[k] / std::max(std::abs(root[k]), kLeastRootOfLag);
      };
      const double half = 0.5 * s.period;
      for (int k = 0; k + 1 < s.samples; ++k)
        out[static_cast<std::size_t>(k)] =
            0.5 * (slope(k) + slope(k + 1)) * (y[k + 1] - y[k]) +
            half * (y[k] * Curvature(root[k], rate[k]) + y[k + 1] * Curvature(root[k + 1], rate[k + 1]));
    };
    const auto stroke_volume = IntegralOver(Of<kSpeed>(), Of<kPressureRate>());
    const auto null = IntegralOverTime<kFlowRoot, kPressureRate>(
        [](double root, double rate) { return Curvature(root, rate); });
    return EffectVariant{{flow, stroke_volume, null}, WeightsOf<kFlowArea, kStrokeVolume, kFlowNull>};
  };
  e.grid = {{0.005}};
  return e;
}

}  // namespace hydroscope::effects
