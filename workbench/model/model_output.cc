#include "workbench/model/model_output.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/constants.h"
#include "core/effect_units.h"
#include "core/short_number.h"
#include "core/units.h"
#include "models/effect.h"
#include "models/expressions/user_effect.h"
#include "models/machine_kind.h"
#include "models/state_effects.h"

namespace hydroscope {
namespace {

std::vector<std::string> NeededSignals(const MachineKind& kind, const Effect& effect) {
  std::vector<std::string> names;
  for (const int channel : effect.channels) names.emplace_back(kind.channels[channel]);
  return names;
}

/// SI unit of a geometry value, "" if the model does not know it.
std::string_view GeometrySi(const Machine& machine, const std::string& name) {
  for (const MachineInput& input : KindOf(machine).geometry)
    if (input.name == name) return input.si;
  return "";
}

std::string OrDash(const std::vector<std::string>& words) {
  return words.empty() ? "-" : fmt::format("{}", fmt::join(words, ", "));
}

const MachineKind& KindOfAny(const Machine* machine) {
  return machine == nullptr ? *MachineKinds().front() : KindOf(*machine);
}

/// The library of the machine's balance, then its own effects.
std::vector<Effect> EffectsOf(const Machine* machine) {
  const MachineKind& kind = KindOfAny(machine);
  if (machine != nullptr && kind.has_states) return StateEffectsOf(*machine);
  std::vector<Effect> effects;
  if (kind.effects != nullptr)
    for (const auto& effect : kind.effects({})) effects.push_back(*effect);
  if (machine != nullptr)
    for (const UserEffectSpec& spec : machine->user_effects)
      effects.push_back(DescribeUserEffect(*machine, spec, std::string(OutputSi(*machine))));
  return effects;
}

/// "C_o, l/min per sqrt(bar)", or of several "F_d, N; v_d, mm/s".
std::string ParametersText(const Effect& e) {
  const auto with_unit = [](const std::string& name, const std::string& si) {
    const std::string unit(EffectUnitFor(si).name);
    return name + ", " + (unit.empty() ? "unit not given" : unit);
  };
  if (e.parameters.size() < 2) return with_unit(e.parameter, e.unit);
  std::string text;
  for (const ParameterSpec& p : e.parameters) text += (text.empty() ? "" : "; ") + with_unit(p.name, p.unit);
  return text;
}

std::string EffectText(const MachineKind& kind, const Effect& e) {
  const EffectUnit unit = EffectUnitFor(e.unit);
  std::string text = fmt::format(
      "{}: {}\n{}  law            {}   ({})\n  parameter      {}\n", e.id, e.title,
      e.plain.empty() ? "" : "  " + e.plain + "\n", e.law, e.source,
      std::isfinite(e.typical)
          ? fmt::format("{}, typically {} {}", e.parameter, ShortNumber(e.typical * unit.factor), unit.name)
          : ParametersText(e));
  for (const NonlinearParameter& n : e.nonlinear) {
    const EffectUnit shown = EffectUnitFor(n.unit);
    text += fmt::format("                 {}, found between {} and {} {}\n", n.name,
                        ShortNumber(n.min * shown.factor), ShortNumber(n.max * shown.factor), shown.name);
  }
  text += fmt::format("  confused with  {}\n  hidden in      {}\n", OrDash(e.confused_with), e.hidden_in);
  if (!e.told_apart_by.empty()) text += fmt::format("  told apart by  {}\n", e.told_apart_by);
  if (!e.measured_by.empty()) text += fmt::format("  measured by    {}\n", e.measured_by.english);
  if (!e.channels.empty())
    text += fmt::format("  needs signal   {}\n", fmt::join(NeededSignals(kind, e), ", "));
  return text;
}

nlohmann::json GermanJson(const Effect& effect) {
  const Effect::German& german = effect.german;
  return {{"title", german.title},
          {"plain", german.plain},
          {"told_apart_by", german.told_apart_by},
          {"measured_by", effect.measured_by.InGerman()}};
}

nlohmann::json EffectJson(const MachineKind& kind, const Effect& e) {
  nlohmann::json nonlinear = nlohmann::json::array();
  for (const NonlinearParameter& n : e.nonlinear)
    nonlinear.push_back({{"name", n.name}, {"unit", n.unit}, {"min", n.min}, {"max", n.max}});
  return {{"id", e.id},
          {"title", e.title},
          {"law", e.law},
          {"source", e.source},
          {"parameter", e.parameter},
          {"unit", e.unit},
          {"min", e.min},
          {"max", e.max},
          {"typical", e.typical},
          {"nonlinear", nonlinear},
          {"confused_with", e.confused_with},
          {"hidden_in", e.hidden_in},
          {"plain", e.plain},
          {"told_apart_by", e.told_apart_by},
          {"german", GermanJson(e)},
          {"measured_by", e.measured_by.english},
          {"signals", NeededSignals(kind, e)}};
}

}  // namespace

std::string EffectsText(const Machine* machine) {
  std::string text =
      machine == nullptr
          ? fmt::format("Effects that the model of a {} may be missing\n", KindOfAny(machine).title)
          : fmt::format("Effects that the model of {} may be missing\n", machine->name);
  const std::vector<Effect> effects = EffectsOf(machine);
  if (effects.empty()) return text + "\nnone is known\n";
  for (const Effect& effect : effects) text += "\n" + EffectText(KindOfAny(machine), effect);
  return text +
         fmt::format("\nAdd one to a machine: hydroscope model add {} --machine FILE\n", effects.front().id);
}

nlohmann::json EffectsJson(const Machine* machine) {
  nlohmann::json out = nlohmann::json::array();
  for (const Effect& effect : EffectsOf(machine)) out.push_back(EffectJson(KindOfAny(machine), effect));
  return {{"effects", out}};
}

std::string ModelText(const Machine& machine) {
  std::string text =
      fmt::format("{}: model {}, version {}\n", machine.name, machine.model, machine.model_version);
  if (!machine.description.empty()) text += fmt::format("{}\n", machine.description);
  if (!machine.geometry.empty()) text += "\nKnown\n";
  for (const auto& [name, known] : machine.geometry) {
    const DisplayUnit unit = DisplayUnitFor(GeometrySi(machine, name));
    text += fmt::format("  {:<8} {}", name, ShortNumber(known.value * unit.factor, 6));
    if (known.std > 0) text += " ± " + ShortNumber(kNormal95 * known.std * unit.factor, 2);
    text += fmt::format(" {}\n", unit.name);
  }
  text += "\nSignals\n";
  for (const SignalSpec& signal : machine.signals)
    text += fmt::format("  {:<8} column {}, {}\n", signal.name, signal.column, signal.unit);
  text += "\nEffects that are part of the model\n";
  if (machine.added_effects.empty()) text += "  none\n";
  for (const std::string& id : machine.added_effects)
    for (const Effect& effect : EffectsOf(&machine))
      if (effect.id == id) text += fmt::format("  {:<28} {}; {}\n", id, effect.title, effect.law);
  return text +
         fmt::format("\nThe values of its parameters come from data: hydroscope {} LOG --machine FILE\n",
                     MeasuredByResponse(KindOf(machine)) ? "frf" : "fit");
}

nlohmann::json ModelJson(const Machine& machine) {
  nlohmann::json geometry = nlohmann::json::object();
  for (const auto& [name, known] : machine.geometry)
    geometry[name] = {{"value", known.value}, {"std", known.std}};
  nlohmann::json signals = nlohmann::json::array();
  for (const SignalSpec& signal : machine.signals) signals.push_back(signal.name);
  return {
      {"machine", machine.name},          {"model", machine.model}, {"model_version", machine.model_version},
      {"effects", machine.added_effects}, {"geometry", geometry},   {"signals", signals}};
}

}  // namespace hydroscope
