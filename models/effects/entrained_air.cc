#include <algorithm>

#include "models/effects/effects.h"
#include "models/wide_stretch.h"

namespace hydroscope::effects {
namespace {

/// Share of its volume at 1 atm that free air has given up: 1 - (p_atm / p_abs)^(1/n), slope = -1/n.
double Compressed(double log_absolute, double slope) { return 1.0 - Exp(log_absolute * slope); }

Column::Fill DeadVolume(double exponent) {
  return [slope = -1.0 / exponent](const Stretch& s, double&, std::span<double> out) {
    const double* p = s[kLogAbsolute];
    wide::Differences(
        s, [=](int k) { return -Compressed(p[k], slope); }, out);
  };
}

Column::Fill StrokeVolume(double exponent) {
  return [slope = -1.0 / exponent](const Stretch& s, double&, std::span<double> out) {
    const double *p = s[kLogAbsolute], *z = s[kPosition];
    wide::IntegrateOver(
        s, [=](int k) { return -z[k]; }, [=](int k) { return Compressed(p[k], slope); }, out);
  };
}

}  // namespace

/// Free air in the oil column: volume (V0 + A z) a compressed with p, so the bulk modulus falls at low
/// pressure (Nykanen, Esque, Ellman 2000; isothermal n = 1 to adiabatic n = 1.4).
Effect EntrainedAir(const CushionGeometry& geometry) {
  Effect e;
  e.id = "entrained_air";
  e.title = "Entrained air in the oil";
  e.law = "dV/dp = a (V0 + A z) (p_atm/p)^(1/n) / (n p)";
  e.source = "Nykanen, Esque, Ellman 2000 (free-air model of effective bulk modulus)";
  e.parameter = "a";
  e.unit = "1";
  e.max = 0.5;
  e.typical = 0.01;
  e.nonlinear = {{"n", "1", 1.0, 1.4}};
  e.confused_with = {"accumulator"};
  e.hidden_in = "K, V0";
  e.plain =
      "Free air in the oil makes the column soft at low pressure; look for: foam in the tank, low oil level, "
      "a leaking "
      "suction line, a column not bled after repair.";
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
