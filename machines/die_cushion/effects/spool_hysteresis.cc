#include <algorithm>
#include <numbers>

#include "core/parallel/wide.h"
#include "machines/die_cushion/effects/effects.h"

namespace hydroscope::effects {

namespace {

/// Edge minus spool where a stroke begins: the spool's way just before tells most of it.
double FirstLag(const Stretch& s, double reach) {
  const double* y = s[kSpool];
  double edge = y[-s.before];
  for (int k = -s.before; k <= 0; ++k) edge = std::min(std::max(edge, y[k] - reach), y[k] + reach);
  return edge - y[0];
}

/// The spool at sample `k`, the share `thinned` of the way to where every second sample alone shows it.
inline double SpoolAt(const double* y, int k, double thinned) {
  return (k & 1) != 0 ? y[k] + thinned * (0.5 * (y[k - 1] + y[k + 1]) - y[k]) : y[k];
}

/// Increments of root times lag, per width. `lag` is edge minus spool, within +- width / 2; it lives on from
/// stretch to stretch. Only the edge waits for the sample before.
HYDROSCOPE_WIDE void FollowEdge(const Stretch& s, double width, double thinned, double& lag,
                                std::span<double> out) {
  const double *root = s[kFlowRoot], *y = s[kSpool];
  const double reach = 0.5 * width, scale = 0.5 * s.period / width;
  if (!s.continues) lag = FirstLag(s, reach);
  double edge = y[0] + lag, left = root[0] * lag;
  for (int k = 0; k + 1 < s.samples; ++k) {
    const double spool = k + 2 < s.samples ? SpoolAt(y, k + 1, thinned) : y[k + 1];
    edge = std::min(std::max(edge, spool - reach), spool + reach);
    lag = edge - spool;
    const double right = root[k + 1] * lag;
    out[k] = scale * (left + right);
    left = right;
  }
}

/// The edge in place of the spool, as far as the spool is known.
void PutEdge(double width, double& lag, Stretch& s) {
  double* y = s[kSpool];
  const double reach = 0.5 * width;
  if (!s.continues) lag = FirstLag(s, reach);
  double edge = y[0] + lag, last = lag;
  for (int k = 0; k < s.samples + s.after; ++k) {
    edge = std::min(std::max(edge, y[k] - reach), y[k] + reach);
    if (k == s.samples - 1) last = edge - y[k];
    y[k] = edge;
  }
  for (int k = -s.before; k < 0; ++k) y[k] += lag;
  lag = last;
}

}  // namespace

/// The metering edge follows the measured spool with play: it moves only after the spool has turned by the
/// width w (play operator, Visintin 1994, sec. III.1).
Effect SpoolHysteresis(const CushionGeometry&) {
  Effect e;
  e.id = "spool_hysteresis";
  e.title = "Play between measured spool and metering edge";
  e.law = "y_eff = play(y_v; w)";
  e.source = "Visintin 1994, sec. III.1 (play operator)";
  e.parameter = "w";
  e.unit = "1";
  e.max = 0.1;
  e.typical = 0.004;
  e.nonlinear = {{"play", "1", 0.0005, 0.1}};
  // How far the spool went between samples, and how far its noise seems to push the edge, no sample tells: up to what it does to
  // the size that only every second sample is known, evenly likely.
  e.constants = {{"thinned", "1", 0, std::numbers::inv_sqrt3}};
  e.implied = [](const ShapeContext& c) { return c.size; };
  e.family = {"the valve follows its spool position with play",
              "das Ventil folgt seiner Schieberstellung mit Spiel"};
  e.confused_with = {"spool_signal_delay"};
  e.hidden_in = "-";
  e.plain =
      "The edge lags behind the measured spool when it turns; look for: play in the position transducer, a "
      "sticking spool, silt in the pilot stage.";
  e.german = {"Spiel zwischen gemessenem Schieber und Steuerkante",
              "Die Kante bleibt hinter dem gemessenen Schieber zurück, wenn er umkehrt; zu suchen: Spiel im "
              "Wegaufnehmer, ein klemmender Schieber, Schlamm in der Vorstufe."};
  e.shown_by = {"strokes in which the spool turns back and forth while the ram moves",
                "Hübe, in denen der Schieber hin und her geht, während der Stößel fährt"};
  e.variant = [](const std::vector<double>& nonlinear) {
    const double thinned = nonlinear.size() > 1 ? nonlinear[1] : 0.0;
    const auto flow = [width = nonlinear[0], thinned](const Stretch& s, double& lag, std::span<double> out) {
      FollowEdge(s, width, thinned, lag, out);
    };
    return EffectVariant{{flow}, WeightsOf<kFlowArea>};
  };
  e.correct = [](double width, double& lag, Stretch& s) {
    PutEdge(width, lag, s);
    FillLogarithms(s);
  };
  e.grid = {{0.002}, {0.005}, {0.01}};
  return e;
}

}  // namespace hydroscope::effects
