#include <algorithm>

#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"

namespace hydroscope::effects {
namespace {

constexpr double kLeastRatio = 0.1;  ///< of K to K_0, where the law ends

/// Pressure that would compress as much at K_0, less the pressure itself, per x = m / K_0: (ln(1 + x p) / x -
/// p) / x.
double StiffeningLevel(double p, double x) { return (Log(std::max(1.0 + x * p, kLeastRatio)) / x - p) / x; }

}  // namespace

/// The oil column stiffens with pressure, K = K_0 + m p: dp / K integrates to ln(1 + x p) / (x K_0) with x =
/// m / K_0, the nonlinear parameter (ISO 6073; Merritt 1967, sec. 1-3).
Effect PressureDependentBulkModulus(const CushionGeometry& geometry) {
  Effect e;
  e.id = "pressure_dependent_bulk_modulus";
  e.title = "Bulk modulus grows with pressure";
  e.law = "K = K_0 + m p_A";
  e.source = "ISO 6073:1997, prediction of bulk moduli; Merritt 1967, sec. 1-3";
  e.parameter = "m";
  e.unit = "1";
  e.max = 100;
  e.typical = 5;
  e.nonlinear = {{"x", "1/Pa", 1e-10, 1e-7}};
  e.implied = [area = geometry.piston_area](const ShapeContext& c) {
    return c.size / std::max(-area / c.theta[2], 1e6);
  };
  e.family = {"the stiffness of the oil column goes with the pressure",
              "die Steifigkeit der Ölsäule geht mit dem Druck"};
  e.confused_with = {"entrained_air", "accumulator"};
  e.hidden_in = "K, V0";
  e.plain =
      "The oil column is stiffer at high pressure than at low pressure; some 5 to 12 is a property of every "
      "oil. Look for: hoses that stiffen, finely spread air, if it is more.";
  e.german = {
      "Kompressionsmodul wächst mit dem Druck",
      "Die Ölsäule ist bei hohem Druck steifer als bei kleinem; etwa 5 bis 12 ist eine Eigenschaft "
      "jedes Öls. Ist es mehr, zu suchen: Schläuche, die sich versteifen, fein verteilte Luft.",
      "Hübe, die bei einigen bar beginnen: Luft macht die Säule unter etwa 30 bar weich, Öl versteift "
      "gleichmäßig bis zum höchsten Druck"};
  e.told_apart_by =
      "strokes that start from a few bar: air makes the column soft below some 30 bar, oil stiffens evenly "
      "up to the highest pressure";
  e.variant = [area = geometry.piston_area](const std::vector<double>& nonlinear) {
    const auto dead_volume =
        ChangeOf<kPressureA>([x = nonlinear[0]](double p) { return StiffeningLevel(p, x); });
    const auto stroke_volume = IntegralOver(
        Of<kPosition>(), Of<kPressureA>([x = nonlinear[0]](double p) { return StiffeningLevel(p, x); }));
    return EffectVariant{{dead_volume, stroke_volume}, [area](const ShapeContext& c) {
                           const double per_modulus = -c.theta[2] / area;  // 1 / K_0
                           return std::vector<double>{c.theta[1] * per_modulus, c.theta[2] * per_modulus};
                         }};
  };
  e.grid = {{2e-9}, {2e-8}};
  return e;
}

}  // namespace hydroscope::effects
