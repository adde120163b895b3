
#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/strokes.h"

namespace hydroscope::effects {
namespace {

/// Share of its volume at 1 bar that free air still has, (1 bar / p_abs)^(1/n), from ln(p_abs / atm); slope = -1/n.
double Left(double log_absolute, double slope) {
  constexpr double kLogAtmosphere = 0.012916;  // ln(1.013 bar / 1 bar)
  return Exp((log_absolute + kLogAtmosphere) * slope);
}

Column::Fill DeadVolume(double exponent) {
  return ChangeOf<kLogAbsolute>([slope = -1.0 / exponent](double p) { return Left(p, slope); });
}

Column::Fill StrokeVolume(double exponent) {
  return IntegralOver(Of<kPosition>(),
                      Of<kLogAbsolute>([slope = -1.0 / exponent](double p) { return Left(p, slope); }));
}

}  // namespace

/// Free air in the oil column: a volume V0 + A z of oil holds a times as much air, counted at 1 bar, which p
/// compresses, so the bulk modulus falls at low pressure (Nykanen, Esque, Ellman 2000; isothermal n = 1 to adiabatic
/// n = 1.4, which nobody knows).
Effect EntrainedAir(const CushionGeometry& geometry) {
  Effect e;
  e.id = "entrained_air";
  e.title = "Entrained air in the oil";
  e.law = "dV/dp = a (V0 + A z) (1 bar/p)^(1/n) / (n p)";
  e.source = "Nykanen, Esque, Ellman 2000 (free-air model of effective bulk modulus)";
  e.parameter = "a";
  e.unit = "1";
  e.max = 0.5;
  e.typical = 0.01;
  e.nonlinear = {{"n", "1", 1.0, 1.4, kPolytropicStd}};
  e.edition = "at 1 bar";
  e.family = {"the oil column is softer at low pressure", "die Ölsäule ist bei niedrigem Druck weicher"};
  e.confused_with = {"accumulator"};
  e.hidden_in = "K, V0";
  e.plain =
      "Free air in the oil makes the column soft at low pressure; look for: foam in the tank, low oil level, "
      "a leaking suction line, a column not bled after repair.";
  e.german = {
      "Luft im Öl",
      "Freie Luft im Öl macht die Säule bei kleinem Druck weich; zu suchen: Schaum im Tank, niedriger "
      "Ölstand, undichte Saugleitung, eine nach der Reparatur nicht entlüftete Säule."};
  e.shown_by = kLowPressure;
  e.separations = {{"accumulator", kLowPressure}};
  e.variant = [area = geometry.piston_area](const std::vector<double>& nonlinear) {
    const double exponent = nonlinear[0];
    return EffectVariant{{DeadVolume(exponent), StrokeVolume(exponent)}, [area](const ShapeContext& c) {
                           return std::vector<double>{area * c.theta[1] / c.theta[2], area};
                         }};
  };
  e.grid = {{1.0}, {1.4}};
  return e;
}

}  // namespace hydroscope::effects
