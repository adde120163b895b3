
#include <cmath>
#include <numbers>

#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"
#include "models/stretch.h"

namespace hydroscope::effects {

/// A flow that swings at one frequency all through the log, Q_d sin(2 pi f t + phi), whatever the strokes do:
/// ripple of a pump, a swinging accumulator, hum on a reading. A reading that swings looks the same: z by Q_d
/// / (2 pi f A_A), p_A by Q_d K / (2 pi f (V_0 + A z)). Frequency and phase come from a search over tones
/// (diagnosis/remainder/tone_search.h); no grid would hold them.
Effect PeriodicDisturbance(const CushionGeometry&) {
  Effect e;
  e.id = "periodic_disturbance";
  e.title = "Periodic disturbance (ripple or hum)";
  e.law = "Q = Q_d sin(2 pi f t + phi), t from the beginning of the log";
  e.source = "Priestley 1981, sec. 6.1 (hidden periodicities)";
  e.parameter = "Q_d";
  e.unit = "m3/s";
  e.max = 1e-2;
  e.typical = 5e-6;
  e.nonlinear = {{"frequency", "Hz", 0.5, 1000.0}, {"phase", "rad", -std::numbers::pi, std::numbers::pi}};
  e.family = {"something swings at one frequency", "etwas schwingt mit einer Frequenz"};
  e.where = [](const std::vector<double>& at) { return Tell("at {:.3g} Hz", "bei {:.3g} Hz", at[0]); };
  e.confused_with = {};
  e.hidden_in = "-";
  e.plain =
      "Flow or a reading swings at one steady frequency, also where the strokes differ; look for: pump "
      "ripple, a swinging relief valve, mains hum, a loose sensor.";
  e.german = {"Periodische Störung (Pulsation oder Brumm)",
              "Durchfluss oder Messwert schwingt mit einer festen Frequenz, auch wo sich die Hübe "
              "unterscheiden; zu suchen: Pulsation der Pumpe, ein schwingendes Druckbegrenzungsventil, "
              "Netzbrumm, ein loser Sensor.",
              "dieselben Signale bei stehendem Stößel, die Pumpe einmal an und einmal aus: Brumm im Messwert "
              "bleibt, Pulsation des Durchflusses geht mit der Pumpe"};
  e.told_apart_by =
      "the same signals with the ram at rest, the pump once on and once off: hum on a reading stays, ripple "
      "of the flow goes with the pump";
  e.variant = [](const std::vector<double>& nonlinear) {
    const double omega = 2.0 * std::numbers::pi * nonlinear[0], phase = nonlinear[1];
    const auto in_phase = ChangeOf<kTime>([omega](double t) { return -std::cos(omega * t) / omega; });
    const auto quadrature = ChangeOf<kTime>([omega](double t) { return std::sin(omega * t) / omega; });
    return EffectVariant{{in_phase, quadrature}, [phase](const ShapeContext&) {
                           return std::vector<double>{std::cos(phase), std::sin(phase)};
                         }};
  };
  e.grid = {};
  return e;
}

}  // namespace hydroscope::effects
