#include "models/parameter_unit.h"

#include "core/constants.h"
#include "core/effect_units.h"
#include "core/interval_text.h"

namespace hydroscope {

DisplayUnit ParameterUnit(const MachineKind& kind, std::string_view parameter, std::string_view si) {
  const MachineParameter* known = FindParameter(kind, parameter);
  if (known != nullptr && !known->shown.empty()) return {known->factor, 0, known->shown};
  const bool of_effect = known == nullptr && parameter.find('.') != std::string_view::npos;
  DisplayUnit unit = of_effect ? DisplayUnitOfEffect(si) : DisplayUnitFor(si);
  if (unit.name == "1" || unit.name.empty()) unit.name = "-";
  return unit;
}

bool ToldInPercent(const MachineKind& kind, std::string_view parameter, std::string_view si) {
  const MachineParameter* known = FindParameter(kind, parameter);
  return known != nullptr ? known->relative : si != "K";
}

ShownParameter ShowParameter(const MachineKind& kind, std::string_view parameter, double value, double std,
                             const std::string& si) {
  const MachineParameter* known = FindParameter(kind, parameter);
  const bool own = known != nullptr && !known->shown.empty();
  const EffectUnit unit = own ? EffectUnit{known->factor, std::string(known->shown)} : EffectUnitFor(si);
  const double offset = own ? 0 : DisplayUnitFor(si).offset;
  const double shown = value * unit.factor + offset, half_width = kNormal95 * std * unit.factor;
  return {kind.has_states ? FoundWithInterval(shown, half_width) : WithInterval(shown, half_width),
          unit.name == "-" ? "" : unit.name};
}

std::string ParameterWithInterval(const MachineKind& kind, std::string_view parameter, double value,
                                  double std, const std::string& si) {
  const ShownParameter shown = ShowParameter(kind, parameter, value, std, si);
  return shown.unit.empty() ? shown.numbers : shown.numbers + " " + shown.unit;
}

}  // namespace hydroscope
