#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"

namespace hydroscope::effects {
namespace {

constexpr double kLeastOilSpan = 3.0;  ///< K; below it the leak is one like any other

}  // namespace

/// A laminar leak past the seal that grows as the oil thins: viscosity falls exponentially with temperature
/// (Reynolds 1886), Q = G (p_A - p_B) exp(beta (T - 40 degC)); mineral oils have beta of 0.02 to 0.05 1/K.
Effect LeakageTemperature(const CushionGeometry&) {
  Effect e;
  e.id = "leakage_temperature";
  e.title = "Leakage that grows with oil temperature";
  e.law = "Q = G (p_A - p_B) exp(beta (T_oil - 40 degC))";
  e.source = "Merritt 1967, eq. 2-32 with the viscosity of Reynolds 1886";
  e.parameter = "G";
  e.unit = "m3/(s Pa)";
  e.max = 1e-9;
  e.typical = 2e-12;
  e.nonlinear = {{"beta", "1/K", 0.005, 0.1}};
  e.family = {"oil is lost", "Öl geht verloren"};
  e.confused_with = {"internal_leakage", "external_leakage", "Q_vn_drift"};
  e.hidden_in = "Q_vn, y_0";
  e.plain =
      "Oil leaks past the seal, and more so when it is warm; look for: worn rings, "
      "oil of too low a viscosity, the cooler.";
  e.german = {"Leckage, die mit der Öltemperatur wächst",
              "Öl strömt an der Dichtung vorbei, und mehr davon, wenn es warm ist; zu suchen: verschlissene "
              "Ringe, Öl zu geringer Viskosität, der Kühler.",
              "Druck halten bei stehendem Stößel, einmal mit kaltem und einmal mit warmem Öl"};
  e.told_apart_by = "a pressure hold with the ram at rest, once with cold and once with warm oil";
  e.channels = {kPressureB, kOilTemperature};
  e.least_span = OilWarmsBy(kLeastOilSpan);
  e.variant = [](const std::vector<double>& nonlinear) {
    return PlainVariant(IntegralOverTime<kPressureA, kPressureB, kOilTemperature>(
        [beta = nonlinear[0]](double a, double b, double t) {
          return -(a - b) * Exp(beta * (t - kStatedAt));
        }));
  };
  e.grid = {{0.02}, {0.04}};
  return e;
}

}  // namespace hydroscope::effects
