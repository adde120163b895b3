#include "models/machine_kind.h"

namespace hydroscope {

const MachineKind* FindKind(std::string_view id) {
  for (const MachineKind* kind : MachineKinds())
    if (kind->id == id) return kind;
  return nullptr;
}

const MachineKind& KindOf(const Machine& machine) {
  static const MachineKind kNone = [] {
    MachineKind none;
    none.words = [](const Machine&) {
      return MachineWords{"output", "stroke", "what drives the machine", "", false};
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

std::vector<std::string> KindNames() {
  std::vector<std::string> names;
  for (const MachineKind* kind : MachineKinds()) names.emplace_back(kind->id);
  return names;
}

std::string_view OutputSi(const Machine& machine) {
  const MachineKind& kind = KindOf(machine);
  return kind.output_unit.empty() ? std::string_view(machine.balance.unit) : kind.output_unit;
}

MachineWords WordsOf(const Machine& machine) { return KindOf(machine).words(machine); }

}  // namespace hydroscope
