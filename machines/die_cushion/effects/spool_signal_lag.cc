#include <vector>

#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/low_passed_signal.h"

namespace hydroscope::effects {
namespace {

/// Effect::Twin::excess: neither column has a rate, and the right one leaves up to 0.002 more than the other
/// (`hydroscope benchmark late-signals --cases 96`, seeds 771 and 5).
constexpr double kSpoolExcess = 0.02;

}  // namespace

/// The spool reading follows the spool as a first-order lag: y_v = y + tau dy/dt of what was measured. The
/// flow it lacks, integrated, is the integral of root(dp) over y, without any rate.
Effect SpoolSignalLag(const CushionGeometry&) {
  Effect e = FirstOrderLag();
  e.id = "spool_signal_lag";
  e.title = "Spool signal lags (first-order filter)";
  e.law = "y_v = y_measured + tau dy_measured/dt";
  e.source = "eq. 2 of the press paper with the signal filtered";
  e.family = {"the spool position is recorded late", "die Schieberstellung wird verspätet aufgezeichnet"};
  e.confused_with = {"spool_signal_delay", "pressure_signal_delay", "spool_hysteresis"};
  e.twins = {{.id = "spool_signal_delay", .least = kDelayGains, .excess = kSpoolExcess}};
  e.unseen_rows = 0.5;  // where its command is held from row to row
  e.hidden_in = "V0, K";
  e.plain =
      "The spool position is smoothed before it is recorded; look for: a filter in the transducer, in the "
      "amplifier or in the controller.";
  e.german = {"Schiebersignal hinkt nach (Filter erster Ordnung)",
              "Die Schieberstellung wird geglättet, bevor sie aufgezeichnet wird; zu suchen: ein Filter im "
              "Aufnehmer, im Verstärker oder in der Steuerung.",
              "die Filtereinstellung des Schiebereingangs, oder ein Sprung des "
              "Ventilsignals, im Stillstand aufgezeichnet"};
  e.told_apart_by = "the filter setting of the spool input, or a step of the valve command recorded at rest";
  e.measured_by = {
      "the time constant of the filter in the spool input, as set there or from a step recorded at rest",
      "die Zeitkonstante des Filters im Schiebereingang, wie dort eingestellt oder aus einem in Ruhe aufgezeichneten Sprung"};
  e.variant = [](const std::vector<double>&) {
    const auto flow = IntegralOver(Of<kFlowRoot>(), Of<kSpool>());
    return EffectVariant{{flow}, WeightsOf<kFlowArea>};
  };
  e.correct = [](double lag, double&, Stretch& s) {
    double* const y = s[kSpool];
    const int first = -s.before, last = s.samples + s.after - 1;
    double before = y[first];
    for (int k = first; k <= last; ++k) {
      const double now = y[k], after = y[k < last ? k + 1 : k];
      y[k] += lag * (after - before) / (2.0 * s.period);
      before = now;
    }
    FillLogarithms(s);
  };
  e.grid = {{0.006}};
  return e;
}

}  // namespace hydroscope::effects
