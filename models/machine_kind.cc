#include "models/machine_kind.h"

#include <algorithm>

#include "core/units.h"

namespace hydroscope {

const MachineKind* FindKind(std::string_view id) {
  for (const MachineKind* kind : MachineKinds())
    if (kind->id == id) return kind;
  return nullptr;
}

const MachineKind& KindOf(const Machine& machine) {
  if (machine.model.empty()) return *MachineKinds().front();
  static const MachineKind kNone = [] {
    MachineKind none;
    none.words = [](const Machine&) {
      return MachineWords{{"output", "Ausgang"},
                          {"stroke", "Hub"},
                          {"what drives the machine", "was die Maschine antreibt"},
                          {},
                          false};
    };
    return none;
  }();
  const MachineKind* kind = FindKind(machine.model);
  return kind == nullptr ? kNone : *kind;
}

const MachineKind& OwnKind() {
  for (const MachineKind* kind : MachineKinds())
    if (kind->own_library) return *kind;
  return *MachineKinds().front();
}

const MachineKind& OwnStatesKind() {
  for (const MachineKind* kind : MachineKinds())
    if (kind->has_states && kind->states == nullptr) return *kind;
  return *MachineKinds().front();
}

StatesSpec BuiltInStates(const Machine& machine) {
  const MachineKind& kind = KindOf(machine);
  if (kind.states == nullptr) return {};
  StatesSpec spec = kind.states(machine);
  spec.episode_seconds = machine.states.episode_seconds;
  spec.shaft = machine.states.shaft;
  std::erase_if(spec.outputs, [&](const OutputSpec& o) { return machine.SignalIndex(o.signal) < 0; });
  return spec;
}

std::vector<std::string> KindNames() {
  std::vector<std::string> names;
  for (const MachineKind* kind : MachineKinds()) names.emplace_back(kind->id);
  return names;
}

std::string_view OutputSi(const Machine& machine) {
  const MachineKind& kind = KindOf(machine);
  if (kind.has_states) {  // several outputs: errors are shares of their variation
    if (machine.states.outputs.size() != 1) return "1";
    const int signal = machine.SignalIndex(machine.states.outputs.front().signal);
    const auto unit = FindUnit(machine.signals[static_cast<std::size_t>(signal)].unit);
    return unit ? unit->si : "1";
  }
  return kind.output_unit.empty() ? std::string_view(machine.balance.unit) : kind.output_unit;
}

void CompleteGate(Machine& machine) {
  const MachineKind& kind = KindOf(machine);
  if (kind.gate == nullptr) return;
  for (GateBound& bound : kind.gate(machine)) {
    const bool has_sign = std::ranges::any_of(machine.gate.bounds, [&](const GateBound& b) {
      const bool one_side = b.magnitude || (b.min && *b.min > 0) || (b.max && *b.max < 0);
      return b.signal == bound.signal && !b.rate && one_side;
    });
    if (!has_sign) machine.gate.bounds.push_back(std::move(bound));
  }
}

MachineWords WordsOf(const Machine& machine) { return KindOf(machine).words(machine); }

MachinePicture PictureOf(const Machine& machine) {
  const MachineKind& kind = KindOf(machine);
  if (kind.picture == nullptr) return PictureOfSignals(machine);
  MachinePicture picture = kind.picture();
  const auto has_place = [&](const SignalSpec& signal) {
    return std::ranges::any_of(picture.places, [&](const SignalPlace& p) { return p.signal == signal.name; });
  };
  const bool names_its_own = kind.signals.empty();  // and what the drawing does not know would not be seen
  return names_its_own && !std::ranges::all_of(machine.signals, has_place) ? PictureOfSignals(machine)
                                                                           : picture;
}

const MachineParameter* FindParameter(const MachineKind& kind, std::string_view name) {
  for (const MachineParameter& parameter : kind.parameters)
    if (parameter.name == name) return &parameter;
  return nullptr;
}

std::vector<Condition> ConditionsOf(const Machine& machine) {
  const std::span<const Condition> of_kind = KindOf(machine).conditions;
  std::vector<Condition> conditions(of_kind.begin(), of_kind.end());
  conditions.insert(conditions.end(), machine.conditions.begin(), machine.conditions.end());
  return conditions;
}

const ClosedLoopPlant* ClosedLoopOf(const Machine& machine) { return KindOf(machine).closed_loop; }

std::vector<int> SignalsOfLoop(const Machine& machine) {
  std::vector<int> signals;
  const ClosedLoopPlant& plant = *ClosedLoopOf(machine);
  for (const std::string_view name : {plant.set_point, plant.input, plant.output})
    signals.push_back(machine.SignalIndex(name));
  return signals;
}

LinearForm LinearFormOf(const Machine& machine) {
  const MachineKind& kind = KindOf(machine);
  return kind.linear_form != nullptr ? kind.linear_form(machine) : LinearForm{};
}

}  // namespace hydroscope
