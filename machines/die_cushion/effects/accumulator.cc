
#include <algorithm>

#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/strokes.h"

namespace hydroscope::effects {
namespace {

/// Oil taken up per gas volume once above the pre-charge: 1 - (p_pre / p)^(1/n), from the logarithms of absolute pressures.
double TakenUp(double log_p, double log_precharge, double slope) {
  return 1.0 - Exp(std::min(log_precharge - log_p, 0.0) * slope);
}

}  // namespace

/// A gas-charged volume at the chamber: takes up V_g (1 - (p_pre/p)^(1/n)) above its pre-charge, pressures above
/// vacuum (Murrenhoff 2012, gas accumulators). How fast the gas gives off its heat, so its exponent, nobody knows.
Effect Accumulator(const CushionGeometry&) {
  Effect e;
  e.id = "accumulator";
  e.title = "Gas-charged volume at chamber A";
  e.law = "V = V_g (1 - (p_pre/p)^(1/n)) for p > p_pre, pressures absolute, n = 1.2 +- 0.12";
  e.source = "Murrenhoff 2012, Grundlagen der Fluidtechnik, gas accumulators";
  e.parameter = "V_g";
  e.unit = "m3";
  e.max = 1e-2;
  e.typical = 2e-5;
  e.nonlinear = {{"p_pre", "Pa", 10e5, 250e5}};
  e.constants = {{"n", "1", kPolytropic, kPolytropicStd}};
  e.edition = "absolute";
  e.family = {"something takes up oil as the pressure rises", "etwas nimmt Öl auf, wenn der Druck steigt"};
  e.where = [](const std::vector<double>& at) {
    return Tell("above {:.0f} bar", "über {:.0f} bar", 1e-5 * at[0]);
  };
  e.confused_with = {"entrained_air"};
  e.hidden_in = "K, V0";
  e.plain =
      "A gas cushion hangs on chamber A and takes up oil above its pre-charge; look for: an accumulator left "
      "open, a trapped air pocket, a soft hose.";
  e.german = {"Gasgefülltes Volumen an Kammer A",
              "An Kammer A hängt ein Gaspolster, das oberhalb seiner Vorspannung Öl aufnimmt; zu suchen: ein "
              "offen gelassener Speicher, eine eingeschlossene Luftblase, ein weicher Schlauch."};
  e.shown_by = kLowPressure;
  e.variant = [](const std::vector<double>& values) {
    const double exponent = values.size() > 1 ? values[1] : kPolytropic;
    return PlainVariant(
        ChangeOf<kLogAbsolute>([log_precharge = Log(values[0] / kAirPressure + 1.0), slope = 1.0 / exponent](
                                   double log_p) { return -TakenUp(log_p, log_precharge, slope); }));
  };
  e.grid = {{40e5}, {80e5}, {120e5}, {160e5}};
  return e;
}

}  // namespace hydroscope::effects
