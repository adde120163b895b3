#include "models/output_unit.h"

#include <string_view>

#include "models/machine_kind.h"

namespace hydroscope {

DisplayUnit OutputUnit(const ModelStructure* model) {
  DisplayUnit unit = DisplayUnitFor(model == nullptr ? std::string_view("m3/s") : model->output_unit);
  unit.offset = 0;  // errors are differences
  return unit;
}

DisplayUnit OutputUnit(const Machine& machine) {
  DisplayUnit unit = DisplayUnitFor(OutputSi(machine));
  unit.offset = 0;
  return unit;
}

std::string_view SiOf(const Machine& machine, std::string_view name) {
  std::string_view unit;
  for (const SignalSpec& signal : machine.signals)
    if (signal.name == name) unit = signal.unit;
  for (const StateSpec& state : machine.states.states)
    if (state.name == name) unit = state.unit;
  if (unit.empty()) return "1";
  const auto known = FindUnit(unit);
  return known ? known->si : unit;
}

}  // namespace hydroscope
