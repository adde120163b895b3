#include "pipeline/log_faults/usual_modulus.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/constants.h"
#include "core/short_number.h"
#include "models/parameter_unit.h"

namespace hydroscope {
namespace {

/// Hoses and some air soften oil to a fifth at most; none is stiffer than water. Pa.
constexpr double kSoftOil = 2e8, kStiffOil = 2.2e9;
/// Data sheets of valves state from some tenths of a l/min to some thousand. m3/s.
constexpr double kLeastNominal = 1e-6, kMostNominal = 0.1;

/// Whether the interval of a parameter reaches into a range. SI.
bool MayLieWithin(const Estimate& parameter, double low, double high) {
  const double margin = kNormal95 * parameter.std;
  return parameter.value + margin >= low && parameter.value - margin <= high;
}

/// Of a value in SI, as people see it in `unit`.
std::string NumberIn(const DisplayUnit& unit, double si) {
  return ShortNumber(si * unit.factor + unit.offset);
}

}  // namespace

Told UnusualModulus(const MachineKind& kind, const Estimate& parameter) {
  if (parameter.parameter != "K" || parameter.unit != "Pa") return {};
  if (MayLieWithin(parameter, kSoftOil, kStiffOil)) return {};
  const DisplayUnit unit = ParameterUnit(kind, parameter.parameter, parameter.unit);
  return Tell(
      "K comes out as {0} {3}, where {1} to {2} {3} are usual: check the scales of pressure and position, and the piston area; only "
      "water-glycol is stiffer, and softer only oil with much air in it",
      "K kommt als {0} {3} heraus, üblich sind {1} bis {2} {3}: die Skalierung von Druck und Position und die Kolbenfläche prüfen; "
      "steifer ist nur Wasser-Glykol, weicher nur Öl mit viel Luft darin",
      NumberIn(unit, parameter.value), NumberIn(unit, kSoftOil), NumberIn(unit, kStiffOil), unit.name);
}

Told ImpossibleFlow(const MachineKind& kind, const Estimate& parameter) {
  const bool nominal = std::ranges::any_of(kind.parameters, [&](const MachineParameter& known) {
    return known.name == parameter.parameter && known.si == "m3/s";
  });
  if (!nominal) return {};
  if (MayLieWithin(parameter, kLeastNominal, kMostNominal)) return {};
  const DisplayUnit unit = ParameterUnit(kind, parameter.parameter, parameter.unit);
  return Tell(
      "{0} comes out as {1} {4}, where valves pass {2} to {3} {4}: check the unit of the spool position (1 or %), those of position and "
      "time, and the piston area in the machine file",
      "{0} kommt als {1} {4} heraus, Ventile lassen {2} bis {3} {4} durch: die Einheit der Schieberstellung (1 oder %), die von "
      "Position und Zeit und die Kolbenfläche in der Maschinendatei prüfen",
      parameter.parameter, NumberIn(unit, parameter.value), NumberIn(unit, kLeastNominal),
      NumberIn(unit, kMostNominal), unit.name);
}

Told UnlikeDataSheet(const Machine& machine, const Estimate& parameter, const StatedValueOptions& options) {
  const MachineKind& kind = KindOf(machine);
  const auto known = std::ranges::find(kind.parameters, parameter.parameter, &MachineParameter::name);
  if (known == kind.parameters.end() || known->stated_as.empty()) return {};
  const auto stated = machine.Geometry(std::string(known->stated_as));
  if (!stated ||
      MayLieWithin(parameter, stated->value / options.most_factor, stated->value * options.most_factor))
    return {};
  const DisplayUnit unit = ParameterUnit(kind, parameter.parameter, parameter.unit);
  return Tell(
      "{0} comes out as {1} {4}, where {2} = {3} {4} in the machine file: unit or scale of a signal or the geometry is wrong, which the "
      "model takes up without an error, or the part is worn or another one",
      "{0} kommt als {1} {4} heraus, in der Maschinendatei steht {2} = {3} {4}: Einheit oder Skalierung eines Signals oder die "
      "Geometrie ist falsch, was das Modell ohne Fehler aufnimmt, oder das Teil ist verschlissen oder ein anderes",
      parameter.parameter, NumberIn(unit, parameter.value), known->stated_as, NumberIn(unit, stated->value),
      unit.name);
}

std::vector<Told> UnusualParameters(const Machine& machine, std::span<const Estimate> parameters) {
  const MachineKind& kind = KindOf(machine);
  std::vector<Told> unusual;
  for (const Estimate& e : parameters)
    if (e.reason != EstimateReason::kOutsidePhysics && std::isfinite(e.value + e.std))
      for (Told text :
           std::array<Told, 3>{UnusualModulus(kind, e), ImpossibleFlow(kind, e), UnlikeDataSheet(machine, e)})
        if (!text.empty()) unusual.push_back(std::move(text));
  return unusual;
}

}  // namespace hydroscope
