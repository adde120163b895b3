#include "setup/kind_columns.h"

#include <algorithm>
#include <optional>
#include <sstream>

#include "setup/column_meaning.h"

namespace hydroscope {
namespace {

/// What a signal is called, best first.
std::vector<std::string> NamesOf(const MachineInput& signal) {
  std::vector<std::string> names = {BareName(std::string(signal.name))};
  std::istringstream usual{std::string(signal.columns)};
  for (std::string name; usual >> name;) names.push_back(name);
  names.push_back(BareName(std::string(signal.meaning.english)));
  names.push_back(BareName(std::string(signal.meaning.german)));
  return names;
}

std::optional<std::size_t> ColumnCalled(const LogColumns& head, const MachineInput& signal,
                                        const std::vector<bool>& taken) {
  for (const std::string& name : NamesOf(signal))
    for (std::size_t i = 0; i < head.columns.size(); ++i)
      if (!taken[i] && head.columns[i].numeric() && BareName(head.columns[i].name) == name &&
          MayBe(signal, head.columns[i]))
        return i;
  return std::nullopt;
}

bool HasAllRequired(const std::vector<KindColumn>& found, const MachineKind& kind) {
  return std::ranges::all_of(kind.signals, [&](const MachineInput& signal) {
    return !signal.required ||
           std::ranges::any_of(found, [&](const KindColumn& column) { return column.signal == &signal; });
  });
}

bool IsBuiltIn(const MachineKind& kind) { return !kind.signals.empty(); }

}  // namespace

std::vector<KindColumn> ColumnsByName(const LogColumns& head, const MachineKind& kind) {
  std::vector<KindColumn> found;
  if (!head.layout.header) return found;
  std::vector<bool> taken(head.columns.size(), false);
  for (const MachineInput& signal : kind.signals) {
    const auto column = ColumnCalled(head, signal, taken);
    if (!column) continue;
    taken[*column] = true;
    const LogColumn& named = head.columns[*column];
    found.push_back(
        {*column, &signal, GuessUnitOf(signal, named), Tell("name \"{}\"", "Name „{}“", named.name)});
  }
  return found;
}

const MachineKind* KindByColumnNames(const LogColumns& head) {
  const MachineKind* best = nullptr;
  std::size_t most = 0;
  for (const MachineKind* kind : MachineKinds()) {
    if (kind->draft.suits != nullptr || !IsBuiltIn(*kind)) continue;
    const std::vector<KindColumn> found = ColumnsByName(head, *kind);
    if (found.size() <= most || !HasAllRequired(found, *kind)) continue;
    best = kind;
    most = found.size();
  }
  return best;
}

std::vector<const MachineKind*> KindsToChoose() {
  std::vector<const MachineKind*> kinds;
  for (const MachineKind* kind : MachineKinds())
    if (IsBuiltIn(*kind) || kind->own_library) kinds.push_back(kind);
  return kinds;
}

}  // namespace hydroscope
