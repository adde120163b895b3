#include <cmath>

#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/strokes.h"

namespace hydroscope::effects {

/// Turbulent leak through a sharp-edged opening, Q = C sign(dp) sqrt|p_A - p_B| (Merritt 1967, eq. 3-5).
Effect OrificeLeakage(const CushionGeometry&) {
  Effect e;
  e.id = "orifice_leakage";
  e.title = "Orifice-like leakage from A to B";
  e.law = "Q = C sign(p_A - p_B) sqrt|p_A - p_B|";
  e.source = "Merritt 1967, eq. 3-5 (sharp-edged orifice)";
  e.parameter = "C";
  e.unit = "m3/(s sqrt(Pa))";
  e.max = 1e-5;
  e.typical = 1e-8;
  e.family = {"oil is lost", "Öl geht verloren"};
  e.confused_with = {"internal_leakage", "external_leakage", "spool_overlap"};
  e.hidden_in = "y_0";
  e.plain =
      "Oil passes through an opening with sharp edges, not a gap; look for: a broken seal ring, a scored "
      "bore, a check valve that does not close, an open bypass.";
  e.german = {
      "Blendenartige Leckage von A nach B",
      "Öl strömt durch eine scharfkantige Öffnung, nicht durch einen Spalt; zu suchen: ein gebrochener "
      "Dichtring, eine Riefe in der Bohrung, ein Rückschlagventil, das nicht schließt, ein offener Bypass."};
  e.shown_by = kPressureSteps;
  e.separations = {{"relief_valve", kPressureSteps}, {"pressure_offset", kRelieved}};
  e.channels = {kPressureB};
  e.variant = [](const auto&) {
    return PlainVariant(IntegralOverTime<kPressureA, kPressureB>(
        [](double a, double b) { return std::copysign(std::sqrt(std::abs(a - b)), b - a); }));
  };
  return e;
}

}  // namespace hydroscope::effects
