#include "machines/own_balance/kind.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

#include "machines/own_balance/draft.h"
#include "models/expressions/balance.h"

namespace hydroscope {
namespace {

/// Signals that the terms of a balance read, in the order of the machine file.
std::vector<std::string> SignalsOfTerms(const Machine& machine) {
  std::set<std::string> names;
  for (const TermSpec& term : machine.balance.terms)
    if (const auto tree = ParseExpression(term.expression)) names.merge(NamesIn(**tree));
  std::vector<std::string> signals;
  for (const SignalSpec& signal : machine.signals)
    if (names.contains(signal.name)) signals.push_back(signal.name);
  return signals;
}

Told ListOf(const std::vector<std::string>& names) {
  if (names.empty()) return {"the signals of its terms", "die Signale ihrer Terme"};
  if (names.size() < 2) return {names.front(), names.front()};
  const std::vector<std::string> first(names.begin(), names.end() - 1);
  return Tell("{} and {}", "{} und {}", fmt::to_string(fmt::join(first, ", ")), names.back());
}

MachineWords OwnWords(const Machine& machine) {
  return {
      .output = machine.balance.output, .stroke = {"stroke", "Hub"}, .vary = ListOf(SignalsOfTerms(machine))};
}

}  // namespace

const MachineKind kOwnBalance = {
    .id = "expressions",
    .title = {"machine with a balance of its own", "Maschine mit eigener Bilanz"},
    .own_library = true,
    .words = OwnWords,
    .temperature = "T_oil",
    .draft = kOwnDraft,
    .build = BuildExpressionBalance};

}  // namespace hydroscope
