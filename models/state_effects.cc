#include "models/state_effects.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "models/machine_kind.h"
#include "models/state_names.h"

namespace hydroscope {
namespace {

constexpr double kAnySize = std::numeric_limits<double>::infinity();

/// What lists and messages show of an effect that is texts: states move by more than the model says ("dp/dt = ... +
/// (-k*p)"), outputs read more.
void Describe(const Machine& machine, Effect& e) {
  if (e.law.empty())
    for (const TermSpec& term : e.adds) {
      const bool state = StateIndex(machine, term.parameter) >= 0;
      e.law += fmt::format("{}{}{}{} = ... + ({})", e.law.empty() ? "" : ", ", state ? "d" : "",
                           term.parameter, state ? "/dt" : "", term.expression);
    }
  e.parameter.clear();
  for (const ParameterSpec& p : e.parameters) e.parameter += (e.parameter.empty() ? "" : ", ") + p.name;
  if (e.parameters.size() == 1) e.unit = e.parameters.front().unit;
  e.min = -kAnySize;
  e.max = e.typical = kAnySize;
  if (e.hidden_in.empty()) e.hidden_in = "-";
}

}  // namespace

Effect DescribeStateEffect(const Machine& machine, const UserEffectSpec& spec) {
  Effect e;
  e.id = spec.id;
  e.title = spec.description.empty() ? spec.id : spec.description;
  e.german.title = spec.german;
  e.source = "machine file";
  e.adds = spec.adds;
  e.parameters = spec.parameters;
  Describe(machine, e);
  return e;
}

std::vector<Effect> StateEffectsOf(const Machine& machine) {
  std::vector<Effect> effects;
  if (const MachineKind& kind = KindOf(machine); kind.effects != nullptr)
    for (const auto& built_in : kind.effects(machine)) {
      Effect e = *built_in;
      std::erase_if(e.adds, [&](const TermSpec& term) {
        return StateIndex(machine, term.parameter) < 0 && OutputIndex(machine, term.parameter) < 0;
      });
      if (e.adds.empty()) continue;
      Describe(machine, e);
      effects.push_back(std::move(e));
    }
  for (const UserEffectSpec& spec : machine.user_effects)
    effects.push_back(DescribeStateEffect(machine, spec));
  return effects;
}

const Effect* FindStateEffect(const std::vector<Effect>& effects, const std::string& id) {
  const auto at = std::find_if(effects.begin(), effects.end(), [&](const Effect& e) { return e.id == id; });
  return at == effects.end() ? nullptr : &*at;
}

}  // namespace hydroscope
