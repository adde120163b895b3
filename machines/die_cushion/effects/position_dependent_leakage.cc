
#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"

namespace hydroscope::effects {

/// A worn zone of the bore: laminar leak in a bell-shaped window over the position,
/// Q = G (p_A - p_B) exp(-((z - c)/w)^2).
Effect PositionDependentLeakage(const CushionGeometry& geometry) {
  Effect e;
  e.id = "position_dependent_leakage";
  e.title = "Leakage in a worn zone of the bore";
  e.law = "Q = G (p_A - p_B) exp(-((z - c)/w)^2)";
  e.source = "Merritt 1967, eq. 2-32 within a window over z";
  e.parameter = "G";
  e.unit = "m3/(s Pa)";
  e.max = 1e-9;
  e.typical = 4e-12;
  e.nonlinear = {{"c", "m", 0.0, geometry.stroke}, {"w", "m", 0.02 * geometry.stroke, 0.5 * geometry.stroke}};
  e.family = {"oil is lost", "Öl geht verloren"};
  e.where = [](const std::vector<double>& at) {
    return Tell("around {:.0f} mm", "um {:.0f} mm", 1e3 * at[0]);
  };
  e.confused_with = {"internal_leakage"};
  e.hidden_in = "Q_vn, y_0";
  e.plain =
      "Oil passes the piston at one place of the stroke only; look for: scoring or wear of the bore at the "
      "position named, side load, dirt.";
  e.german = {
      "Leckage in einer verschlissenen Zone der Bohrung",
      "Öl strömt nur an einer Stelle des Hubs am Kolben vorbei; zu suchen: Riefen oder Verschleiß der "
      "Bohrung an der genannten Position, Querkraft, Schmutz."};
  e.shown_by = {"slow strokes over the whole cylinder length at one high pressure",
                "langsame Hübe über die ganze Zylinderlänge bei einem hohen Druck"};
  e.channels = {kPressureB};
  e.variant = [](const std::vector<double>& nonlinear) {
    return PlainVariant(IntegralOverTime<kPressureA, kPressureB, kPosition>(
        [centre = nonlinear[0], inverse = 1.0 / nonlinear[1]](double a, double b, double z) {
          const double x = (z - centre) * inverse;
          return (b - a) * Exp(-x * x);
        }));
  };
  e.grid.clear();
  for (double share : {0.15, 0.35, 0.55, 0.75, 0.95})
    e.grid.push_back({share * geometry.stroke, 0.1 * geometry.stroke});
  return e;
}

}  // namespace hydroscope::effects
