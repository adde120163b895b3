#include "models/output_unit.h"

#include <string_view>

#include "models/machine_kind.h"

namespace hydroscope {
namespace {

/// As the machine file states it; "" where it states none.
std::string_view StatedUnit(const Machine& machine, std::string_view name) {
  std::string_view unit;
  for (const SignalSpec& signal : machine.signals)
    if (signal.name == name) unit = signal.unit;
  for (const StateSpec& state : machine.states.states)
    if (state.name == name) unit = state.unit;
  return unit;
}

}  // namespace

DisplayUnit OutputUnit(const ModelStructure* model) {
  DisplayUnit unit = DisplayUnitFor(model == nullptr ? std::string_view("m3/s") : model->output_unit);
  unit.offset = 0;  // errors are differences
  return unit;
}

DisplayUnit OutputUnit(const Machine& machine) {
  const auto& outputs = machine.states.outputs;
  const std::string_view signal = outputs.empty()       ? std::string_view(machine.balance.output)
                                  : outputs.size() == 1 ? std::string_view(outputs.front().signal)
                                                        : std::string_view();
  DisplayUnit unit =
      StatedUnit(machine, signal).empty() ? DisplayUnitFor(OutputSi(machine)) : ShownUnit(machine, signal);
  unit.offset = 0;
  return unit;
}

DisplayUnit UnitOfRecord(const Machine& machine, std::string_view si) {
  DisplayUnit unit = si == OutputSi(machine) ? OutputUnit(machine) : DisplayUnitFor(si);
  unit.offset = 0;
  return unit;
}

DisplayUnit UnitOfErrors(const Machine& machine) {
  return machine.states.outputs.size() > 1 ? kOfVariation : OutputUnit(machine);
}

DisplayUnit ShownUnit(const Machine& machine, std::string_view name) {
  const std::string_view stated = StatedUnit(machine, name);
  const auto known = FindUnit(stated);
  if (!known || known->scale == 1) return DisplayUnitFor(SiOf(machine, name));
  return {1 / known->scale, -known->offset / known->scale, stated};
}

std::string_view SiOf(const Machine& machine, std::string_view name) {
  const std::string_view unit = StatedUnit(machine, name);
  if (unit.empty()) return "1";
  const auto known = FindUnit(unit);
  return known ? known->si : unit;
}

}  // namespace hydroscope
