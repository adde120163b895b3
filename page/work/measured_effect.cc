#include "page/work/measured_effect.h"

#include "core/told_error.h"
#include "models/machine_kind.h"
#include "page/http/json_arguments.h"

namespace hydroscope {

Result<MeasuredEffect> ParseMeasuredEffect(const std::string& body) {
  const auto json = TRY(ParseObject(body));
  const auto effect = TRY(TextOf(json, "effect"));
  const auto size = NumberOf(json, "size"), std = NumberOf(json, "std");
  for (const auto* number : {&size, &std})
    if (!*number) return tl::unexpected(number->error());
  if (effect.empty()) return BadInput("effect: expected the id of an effect");
  MeasuredEffect measured{effect, std::nullopt};
  if (!*size) return measured;
  if (!*std || !(**std > 0))
    return BadInput(Told("the standard error of a measurement is above 0",
                         "der Standardfehler einer Messung ist größer als 0"));
  measured.size = MeasuredSize{**size, **std};
  return measured;
}

Status CheckInLibrary(const MeasuredEffect& measured, const Machine& machine) {
  const MachineKind& kind = KindOf(machine);
  if (kind.effects != nullptr)
    for (const auto& effect : kind.effects(machine))
      if (effect->id == measured.effect) return {};
  return BadInput(Tell("effect: the library of '{}' holds no effect '{}'",
                       "die Bibliothek von '{}' kennt keinen Effekt '{}'", machine.name, measured.effect));
}

}  // namespace hydroscope
