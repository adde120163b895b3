#include "machines/die_cushion/effects/misread_pressure.h"

namespace hydroscope::effects {
namespace {

constexpr double kLeastZeroWarming =
    2.0;  // K; over less, five times the typical size moves the zero by 0.5 bar

}  // namespace

/// The zero of the pressure sensor follows the temperature, as data sheets of transmitters state it (0.01 to 0.04 % of the
/// range per K): p = p_measured - r (T - T_0), right at T_0, where it was set.
Effect PressureOffsetTemperature(const CushionGeometry&) {
  Effect e;
  e.id = "pressure_offset_temperature";
  e.title = "Zero of the pressure sensor of chamber A follows the temperature";
  e.law = "p_A = p_measured - r (T_oil - T_0)";
  e.source = "eq. 1-2 of the press paper with the pressure shifted";
  e.parameter = "r";
  e.unit = "Pa/K";
  e.min = -1e5;
  e.max = 1e5;
  e.typical = 5e3;
  e.nonlinear = {{"T_0", "K", 283.15, 313.15}};
  e.family = {"the pressure reading goes with the temperature", "die Druckanzeige geht mit der Temperatur"};
  e.confused_with = {"pressure_offset_drift", "oil_viscosity", "pressure_gain_temperature"};
  e.hidden_in = "-";
  e.plain =
      "The zero of the pressure sensor moves as it warms; look for: a sensor beside hot oil, one outside its compensated "
      "range, one of a much larger range than needed.";
  e.german = {
      "Nullpunkt des Drucksensors der Kammer A folgt der Temperatur",
      "Der Nullpunkt des Drucksensors wandert mit der Erwärmung; zu suchen: ein Sensor an heißem Öl, einer außerhalb seines "
      "kompensierten Bereichs, einer mit viel größerem Messbereich als nötig.",
      "der Drucksensor bei entlastetem Kissen, mit kaltem und mit warmem Öl: beide Werte müssen null sein"};
  e.told_apart_by =
      "the pressure sensor with the cushion relieved, with cold and with warm oil: both readings must be zero";
  e.channels = {kOilTemperature};
  e.least_span = OilWarmsBy(kLeastZeroWarming);
  e.walks = true;
  e.variant = [](const std::vector<double>& nonlinear) {
    constexpr double kUnit = 1e4;  // Pa/K
    return MisreadPressure<kOilTemperature>(kUnit, [set_at = nonlinear[0]](double t) { return t - set_at; });
  };
  e.grid = {{293.15}, {308.15}};
  return e;
}

}  // namespace hydroscope::effects
