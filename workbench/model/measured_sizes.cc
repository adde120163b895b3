#include "workbench/model/measured_sizes.h"

#include <optional>
#include <string_view>

#include "core/effect_units.h"
#include "core/finite_number.h"
#include "core/units.h"
#include "models/machine_kind.h"

namespace hydroscope {
Result<std::map<std::string, MeasuredSize>> MeasuredSizes(const std::vector<std::string>& texts,
                                                          const Machine& machine) {
  const MachineKind& kind = KindOf(machine);
  if (!texts.empty() && kind.effects == nullptr)
    return UsageError("--measured: machine '{}' has no effects of the library", machine.name);
  std::map<std::string, MeasuredSize> measured;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('='), colon = text.find(':');
    if (equals == std::string::npos || colon == std::string::npos || colon < equals)
      return UsageError("--measured {}: expected EFFECT=SIZE:STANDARD_ERROR, such as {}=6.5:0.1", text,
                        kind.effects(machine).front()->id);
    const std::string id = text.substr(0, equals);
    std::vector<std::string> ids;
    std::optional<EffectUnit> unit;
    for (const auto& effect : kind.effects(machine)) {
      ids.push_back(effect->id);
      if (effect->id == id) unit = EffectUnitFor(effect->unit);
    }
    if (!unit) {
      const std::string nearest = Nearest(id, ids);
      return UsageError("--measured {}: the library holds no effect '{}'{}", text, id,
                        nearest.empty() ? "; 'hydroscope model effects' lists them"
                                        : fmt::format("; did you mean '{}'?", nearest));
    }
    const auto size = FiniteNumber(std::string_view(text).substr(equals + 1, colon - equals - 1)),
               std = FiniteNumber(std::string_view(text).substr(colon + 1));
    if (!size || !std || !(*std > 0))
      return UsageError("--measured {}: expected two numbers in {}, the second above 0", text, unit->name);
    measured[id] = {*size / unit->factor, *std / unit->factor};
  }
  return measured;
}

}  // namespace hydroscope
