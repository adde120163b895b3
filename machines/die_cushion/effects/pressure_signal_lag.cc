#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/low_passed_signal.h"
#include "machines/die_cushion/effects/pressure_root.h"

namespace hydroscope::effects {
/// The pressure reading follows the pressure as a first-order lag: p_A = p + tau dp/dt of what was measured,
/// in the flow through the valve and in the compressed volume alike.
Effect PressureSignalLag(const CushionGeometry&) {
  Effect e = FirstOrderLag();
  e.id = "pressure_signal_lag";
  e.title = "Pressure signal lags (first-order filter)";
  e.law = "p_A = p_measured + tau dp_measured/dt";
  e.source = "eq. 1-2 of the press paper with the signal filtered";
  e.family = {"the pressure is recorded late", "der Druck wird verspätet aufgezeichnet"};
  e.confused_with = {"pressure_signal_delay", "spool_signal_delay", "line_inertance"};
  e.twins = {{.id = "pressure_signal_delay", .least = kDelayGains}};
  e.hidden_in = "V0, K";
  e.plain =
      "The pressure is smoothed before it is recorded; look for: a filter in the amplifier or the "
      "controller, a long thin sensor line.";
  e.german = {
      "Drucksignal hinkt nach (Filter erster Ordnung)",
      "Der Druck wird geglättet, bevor er aufgezeichnet wird; zu suchen: ein Filter im Verstärker oder "
      "in der Steuerung, eine lange dünne Messleitung.",
      "die Filtereinstellung des Druckeingangs, oder ein Drucksprung, im Stillstand aufgezeichnet"};
  e.told_apart_by = "the filter setting of the pressure input, or a step of pressure recorded at rest";
  e.measured_by = {
      "the time constant of the filter in the pressure input, as set there or from a step recorded at rest",
      "die Zeitkonstante des Filters im Druckeingang, wie dort eingestellt oder aus einem in Ruhe aufgezeichneten Sprung"};
  e.variant = [](const std::vector<double>& nonlinear) {
    const double lag = nonlinear[0];
    const auto flow =
        IntegralOverTime<kFlowRoot, kSpool, kPressureRate>([lag](double root, double y, double rate) {
          return y * RootShift(root, y, -lag * rate) * (1.0 / lag);
        });
    const auto dead_volume = ChangeOf<kPressureRate>();
    const auto stroke_volume = IntegralOver(Of<kPosition>(), Of<kPressureRate>());
    const auto null = IntegralOverTime<kFlowRoot, kSpool, kPressureRate>(
        [lag](double root, double y, double rate) { return RootShift(root, y, -lag * rate) * (1.0 / lag); });
    return EffectVariant{{flow, dead_volume, stroke_volume, null}, BaseWeights};
  };
  e.correct = [](double lag, double&, Stretch& s) {
    double *p = s[kPressureA], *root = s[kFlowRoot];
    const double *y = s[kSpool], *rate = s[kPressureRate];
    for (int k = -s.before; k < s.samples + s.after; ++k) {
      root[k] += RootShift(root[k], y[k], -lag * rate[k]);
      p[k] += lag * rate[k];
    }
    FillLogarithms(s);
  };
  e.grid = {{0.006}};
  return e;
}

}  // namespace hydroscope::effects
