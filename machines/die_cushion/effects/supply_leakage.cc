#include <cmath>

#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/strokes.h"

namespace hydroscope::effects {
namespace {

/// Effect::Twin::share, and Effect::Twin::excess: of a leak in or out the right one leaves up to 0.005 of the noise energy more than
/// another one (90 random machines, each with one of the three).
constexpr double kLeakShare = 0.9, kLeakExcess = 0.02;

}  // namespace

/// Leak past the valve's worn edge from the supply into chamber A, Q = C sign(dp) sqrt|p_0 - p_A| into it: an edge worn round is
/// a short opening, not a gap (Merritt 1967, eq. 3-5 and sec. 5-3, leakage of the null).
Effect SupplyLeakage(const CushionGeometry&) {
  Effect e;
  e.id = "supply_leakage";
  e.title = "Leakage of the valve from the supply into chamber A";
  e.law = "Q = -C sign(p_0 - p_A) sqrt|p_0 - p_A|";
  e.source = "Merritt 1967, eq. 3-5 (sharp-edged orifice), sec. 5-3 (leakage of the null)";
  e.parameter = "C";
  e.unit = "m3/(s sqrt(Pa))";
  e.max = 1e-5;
  e.typical = 1e-8;
  e.family = {"oil comes in", "Öl strömt zu"};
  // As long as it is small, what comes in from a supply that stands still is a leak out that grows with the pressure less of it.
  e.twins = {{"internal_leakage", kLeakShare, 0, kLeakExcess},
             {"external_leakage", kLeakShare, 0, kLeakExcess}};
  e.hidden_in = "y_0";
  e.plain =
      "Oil comes from the supply into chamber A past a closed edge of the valve; look for: a worn or scored supply edge, dirt "
      "in the valve, a check valve from the supply that does not close.";
  e.german = {
      "Leckage des Ventils von der Versorgung in Kammer A",
      "An einer geschlossenen Kante des Ventils strömt Öl aus der Versorgung in Kammer A; zu suchen: eine verschlissene oder "
      "riefige Versorgungskante, Schmutz im Ventil, ein Rückschlagventil zur Versorgung, das nicht schließt.",
      "Druckhalten bei ruhendem Stößel, einmal mit abgesperrter Versorgung: was dann anders ist, kommt von ihr"};
  e.told_apart_by =
      "a pressure hold with the ram at rest, once with the supply shut off: what then differs comes from it";
  e.shown_by = kPressureSteps;
  e.channels = {kSupplyPressure};
  e.variant = [](const auto&) {
    return PlainVariant(IntegralOverTime<kPressureA, kSupplyPressure>(
        [](double a, double supply) { return std::copysign(std::sqrt(std::abs(supply - a)), supply - a); }));
  };
  return e;
}

}  // namespace hydroscope::effects
