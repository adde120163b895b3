
#include <algorithm>

#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/strokes.h"

namespace hydroscope::effects {

/// A relief valve that opens proportionally above its cracking pressure, Q = G (p_A - p_crack)+ (Merritt
/// 1967, sec. 9-2, static characteristic).
Effect ReliefValve(const CushionGeometry&) {
  Effect e;
  e.id = "relief_valve";
  e.title = "Relief valve opening early";
  e.law = "Q = G max(p_A - p_crack, 0)";
  e.source = "Merritt 1967, sec. 9-2 (direct-acting relief valve, static)";
  e.parameter = "G";
  e.unit = "m3/(s Pa)";
  e.max = 1e-8;
  e.typical = 2e-11;
  e.nonlinear = {{"p_crack", "Pa", 100e5, 350e5}};
  e.family = {"oil is lost", "Öl geht verloren"};
  e.where = [](const std::vector<double>& at) {
    return Tell("above {:.0f} bar", "über {:.0f} bar", 1e-5 * at[0]);
  };
  e.confused_with = {"internal_leakage", "external_leakage"};
  e.hidden_in = "Q_vn";
  e.plain =
      "A relief valve lets oil through at working pressure; look for: a setting too low, a tired spring, "
      "dirt on the seat, a warm return line.";
  e.german = {"Druckbegrenzungsventil öffnet zu früh",
              "Ein Druckbegrenzungsventil lässt bei Arbeitsdruck Öl durch; zu suchen: eine zu niedrige "
              "Einstellung, eine lahme Feder, Schmutz auf dem Sitz, eine warme Rücklaufleitung."};
  e.shown_by = kPressureSteps;
  e.variant = [](const std::vector<double>& nonlinear) {
    return PlainVariant(
        IntegralOverTime<kPressureA>([crack = nonlinear[0]](double p) { return -std::max(p - crack, 0.0); }));
  };
  e.grid = {{120e5}, {150e5}, {170e5}, {190e5}};
  return e;
}

}  // namespace hydroscope::effects
