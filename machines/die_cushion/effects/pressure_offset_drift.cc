#include "machines/die_cushion/effects/misread_pressure.h"

namespace hydroscope::effects {

/// The zero of the pressure sensor moves during the log at r Pa/s: the true pressure is p - r t, t
/// from the beginning of the log, at which the zero is right.
Effect PressureOffsetDrift(const CushionGeometry&) {
  Effect e;
  e.id = "pressure_offset_drift";
  e.title = "Zero of the pressure sensor moves during the log";
  e.law = "p_A = p_measured - r t";
  e.source = "eq. 2 of the press paper with a moving zero";
  e.parameter = "r";
  e.unit = "Pa/s";
  e.min = -1e5;
  e.max = 1e5;
  e.typical = 2e3;
  e.nonlinear = {{"rate", "Pa/s", -1e5, 1e5}};
  e.implied = [](const ShapeContext& c) { return c.size; };
  e.family = {"the pressure reading wanders", "die Druckanzeige wandert"};
  e.confused_with = {"y_0_drift", "Q_vn_drift", "pressure_offset_temperature"};
  e.hidden_in = "-";
  e.plain =
      "The zero of the pressure sensor wanders while the machine runs; look for: a sensor that warms up, a "
      "loose connector, moisture in the plug.";
  e.german = {
      "Nullpunkt des Drucksensors wandert während der Aufzeichnung",
      "Der Nullpunkt des Drucksensors wandert, während die Maschine läuft; zu suchen: ein Sensor, der "
      "warm wird, ein loser Stecker, Feuchtigkeit im Stecker.",
      "der Drucksensor bei entlastetem Kissen, vor und nach dem Lauf: beide Werte müssen null sein"};
  e.told_apart_by =
      "the pressure sensor with the cushion relieved, before and after the run: both readings must be zero";
  e.drifting = {"the zero of the pressure sensor", "der Nullpunkt des Drucksensors"};
  e.drifts_by = "Pa";
  e.walks = true;
  e.variant = [](const std::vector<double>& nonlinear) {
    return MisreadPressure<kTime>(nonlinear[0], [](double t) { return t; });
  };
  e.correct = [](double rate, double&, Stretch& s) {
    double *p = s[kPressureA], *root = s[kFlowRoot];
    const double *y = s[kSpool], *t = s[kTime];
    for (int k = -s.before; k < s.samples + s.after; ++k) {
      root[k] += RootShift(root[k], y[k], rate * t[k]);
      p[k] -= rate * t[k];
    }
    FillLogarithms(s);
  };
  e.grid = {{1e3}};
  return e;
}

}  // namespace hydroscope::effects
