#include "pipeline/log_faults/usual_modulus.h"

#include "core/constants.h"
#include "core/short_number.h"
#include "models/parameter_unit.h"

namespace hydroscope {
namespace {

/// Hoses and some air soften oil to a fifth at most; none is stiffer than water. Pa.
constexpr double kSoftOil = 2e8, kStiffOil = 2.2e9;

}  // namespace

Told UnusualModulus(const MachineKind& kind, const Estimate& parameter) {
  if (parameter.parameter != "K" || parameter.unit != "Pa") return {};
  const double margin = kNormal95 * parameter.std;
  if (parameter.value + margin >= kSoftOil && parameter.value - margin <= kStiffOil) return {};
  const DisplayUnit unit = ParameterUnit(kind, parameter.parameter, parameter.unit);
  const auto shown = [&](double si) { return ShortNumber(si * unit.factor + unit.offset); };
  return Tell(
      "K comes out as {0} {3}, where {1} to {2} {3} are usual: check the scales of pressure and position, and the piston area; only "
      "water-glycol is stiffer, and softer only oil with much air in it",
      "K kommt als {0} {3} heraus, üblich sind {1} bis {2} {3}: die Skalierung von Druck und Position und die Kolbenfläche prüfen; "
      "steifer ist nur Wasser-Glykol, weicher nur Öl mit viel Luft darin",
      shown(parameter.value), shown(kSoftOil), shown(kStiffOil), unit.name);
}

std::vector<Told> UnusualParameters(const MachineKind& kind, std::span<const Estimate> parameters) {
  std::vector<Told> unusual;
  for (const Estimate& e : parameters)
    if (e.reason != EstimateReason::kOutsidePhysics)
      if (Told text = UnusualModulus(kind, e); !text.empty()) unusual.push_back(std::move(text));
  return unusual;
}

}  // namespace hydroscope
