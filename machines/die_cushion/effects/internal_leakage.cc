#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/strokes.h"

namespace hydroscope::effects {

/// Laminar gap flow past the piston seal from A to B, Q = G (p_A - p_B) (Merritt 1967, eq. 2-32 for annular gaps).
Effect InternalLeakage(const CushionGeometry&) {
  Effect e;
  e.id = "internal_leakage";
  e.title = "Internal leakage past the piston seal";
  e.law = "Q = G (p_A - p_B)";
  e.source = "Merritt 1967, eq. 2-32 (laminar annular gap)";
  e.parameter = "G";
  e.unit = "m3/(s Pa)";
  e.max = 1e-9;
  e.typical = 2e-12;
  e.family = {"oil is lost", "Öl geht verloren"};
  e.confused_with = {"external_leakage", "orifice_leakage", "position_dependent_leakage"};
  e.hidden_in = "Q_vn, y_0";
  e.plain =
      "Oil passes the piston seal from one chamber to the other; look for: the cushion sinks when held, warm "
      "cylinder barrel, worn or cut piston seal.";
  e.german = {"Innere Leckage an der Kolbendichtung",
              "Öl strömt an der Kolbendichtung vorbei von einer Kammer in die andere; zu suchen: das Kissen "
              "sinkt beim Halten, warmes Zylinderrohr, verschlissene oder beschädigte Kolbendichtung."};
  e.shown_by = kHoldAndSpeeds;
  e.separations = {{"external_leakage", kRodSide},
                   {"orifice_leakage", kPressureSteps},
                   {"relief_valve", kPressureSteps},
                   {"pressure_offset", kRelieved}};
  e.channels = {kPressureB};
  e.variant = [](const auto&) {
    return PlainVariant(IntegralOverTime<kPressureA, kPressureB>([](double a, double b) { return b - a; }));
  };
  return e;
}

}  // namespace hydroscope::effects
