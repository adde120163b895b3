#include "models/parameter_unit.h"

#include "core/constants.h"
#include "core/interval_text.h"

namespace hydroscope {

DisplayUnit ParameterUnit(const MachineKind& kind, std::string_view parameter, std::string_view si) {
  const MachineParameter* known = FindParameter(kind, parameter);
  if (known != nullptr && !known->shown.empty()) return {known->factor, 0, known->shown};
  DisplayUnit unit = DisplayUnitFor(si);
  if (unit.name == "1" || unit.name.empty()) unit.name = "-";
  return unit;
}

std::string ParameterWithInterval(const MachineKind& kind, std::string_view parameter, double value,
                                  double std, const std::string& si) {
  const MachineParameter* known = FindParameter(kind, parameter);
  if (known == nullptr || known->shown.empty()) return ShownWithInterval(value, std, si);
  return WithInterval(value * known->factor, kNormal95 * std * known->factor) + " " +
         std::string(known->shown);
}

}  // namespace hydroscope
