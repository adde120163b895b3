#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/shifted_signal.h"
#include "machines/die_cushion/effects/strokes.h"
#include "models/wide_stretch.h"

namespace hydroscope::effects {

/// The spool signal arrives t_d late: the flow is theta1 root(dp) y(t + t_d) + ..., so the balance lacks
/// theta1 root(dp) (y(t + t_d) - y(t)).
Effect SpoolSignalDelay(const CushionGeometry&) {
  Effect e = LateSignal();
  e.id = "spool_signal_delay";
  e.title = "Spool signal arrives late";
  e.law = "y_v(t) = y_measured(t + t_d)";
  e.source = "eq. 2 of the press paper with the signal shifted";
  e.family = {"the spool position is recorded late", "die Schieberstellung wird verspätet aufgezeichnet"};
  e.confused_with = {"pressure_signal_delay", "position_signal_delay", "spool_hysteresis"};
  e.unseen_rows = 0.5;  // where its command is held from row to row
  e.hidden_in = "V0, K";
  e.plain =
      "The spool position is recorded later than the other signals; look for: a "
      "filter in the transducer, a bus cycle.";
  e.german = {
      "Schiebersignal kommt verspätet",
      "Die Schieberstellung wird später aufgezeichnet als die anderen Signale; zu suchen: ein Filter im "
      "Aufnehmer, ein Buszyklus."};
  e.shown_by = kSteps;
  e.separations = {
      {"pressure_signal_delay", kSteps}, {"position_signal_delay", kSteps}, {"spool_hysteresis", kSteps}};
  e.variant = [](const std::vector<double>& nonlinear) {
    const auto flow = [delay = nonlinear[0]](const Stretch& s, double&, std::span<double> out) {
      const double *root = s[kFlowRoot], *y = s[kSpool];
      const ShiftedSignal later(s, kSpool, delay);
      wide::IntegrateOverTime(
          s, [&, per_second = 1.0 / delay](int k) { return root[k] * (later(k) - y[k]) * per_second; }, out);
    };
    return EffectVariant{{flow}, WeightsOf<kFlowArea>};
  };
  e.correct = [](double delay, double&, Stretch& s) {
    ShiftChannels(s, {kSpool}, delay);
    FillLogarithms(s);
  };
  return e;
}

}  // namespace hydroscope::effects
