#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/strokes.h"

namespace hydroscope::effects {

/// Laminar leak from chamber A to the outside or to tank, Q = G p_A (Merritt 1967, eq. 2-32).
Effect ExternalLeakage(const CushionGeometry& geometry) {
  Effect e;
  e.id = "external_leakage";
  e.title = "External leakage of chamber A";
  e.law = "Q = G (p_A - p_t)";
  e.source = "Merritt 1967, eq. 2-32 (laminar annular gap)";
  e.parameter = "G";
  e.unit = "m3/(s Pa)";
  e.max = 1e-9;
  e.typical = 2e-12;
  e.family = {"oil is lost", "Öl geht verloren"};
  e.confused_with = {"internal_leakage", "orifice_leakage", "supply_leakage"};
  e.hidden_in = "Q_vn, y_0";
  e.plain =
      "Oil leaves chamber A to tank or to the outside; look for: oil at fittings and hoses, a leaking check "
      "or drain valve, a valve body worn through to tank.";
  e.german = {
      "Leckage der Kammer A nach außen",
      "Öl verlässt Kammer A zum Tank oder nach außen; zu suchen: Öl an Verschraubungen und Schläuchen, "
      "ein undichtes Rückschlag- oder Ablassventil, ein zum Tank hin verschlissenes Ventilgehäuse."};
  e.shown_by = kHoldAndSpeeds;
  e.separations = {
      {"orifice_leakage", kPressureSteps}, {"relief_valve", kPressureSteps}, {"pressure_offset", kRelieved}};
  e.variant = [tank = geometry.tank_pressure](const auto&) {
    return PlainVariant(IntegralOverTime<kPressureA>([tank](double a) { return tank - a; }));
  };
  return e;
}

}  // namespace hydroscope::effects
