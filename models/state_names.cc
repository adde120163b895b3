#include "models/state_names.h"

#include "models/machine_kind.h"
#include "models/state_effects.h"

namespace hydroscope {
namespace {

void AddName(const std::string& name, const std::string& unit, ExpressionNames& names) {
  names.units[name] = unit.empty() ? std::nullopt : ParseSiUnit(unit);
  names.constants.erase(name);
}

void AddParameters(const std::vector<ParameterSpec>& parameters, ExpressionNames& names) {
  for (const ParameterSpec& p : parameters) AddName(p.name, p.unit, names);
}

void AddDelayTimes(const std::vector<ParameterSpec>& parameters, ExpressionNames& names) {
  for (const ParameterSpec& p : parameters)
    if (p.min >= 0) names.delay_times.insert(p.name);
}

}  // namespace

std::string RippleName(const std::string& output) { return output + "_ripple"; }

ExpressionNames StateNamesOf(const Machine& machine, const std::vector<ParameterSpec>& of_effect) {
  ExpressionNames names = ExpressionNamesOf(machine);
  for (const OutputSpec& output : machine.states.outputs) {
    const auto unit = names.units.extract(output.signal);
    if (!machine.states.shaft.empty() && unit) names.units.emplace(RippleName(output.signal), unit.mapped());
  }
  for (const SignalSpec& signal : machine.signals)
    if (OutputIndex(machine, signal.name) < 0) names.delayed.insert(signal.name);
  for (const StateSpec& state : machine.states.states) AddName(state.name, state.unit, names);
  AddParameters(machine.states.parameters, names);
  AddDelayTimes(machine.states.parameters, names);
  AddParameters(of_effect, names);
  AddDelayTimes(of_effect, names);
  return names;
}

ExpressionNames LimitNamesOf(const Machine& machine) {
  ExpressionNames names = ExpressionNamesOf(machine);
  for (const SignalSpec& signal : machine.signals) names.units.erase(signal.name);
  AddParameters(machine.states.parameters, names);
  return names;
}

ExpressionNames InitialNamesOf(const Machine& machine) {
  ExpressionNames names = ExpressionNamesOf(machine);
  AddParameters(machine.states.parameters, names);
  return names;
}

std::string StateParameterUnit(const Machine& machine, const std::string& parameter) {
  for (const ParameterSpec& p : machine.states.parameters)
    if (p.name == parameter) return p.unit;
  for (const Effect& effect : StateEffectsOf(machine))
    for (const ParameterSpec& p : effect.parameters)
      if (effect.id + "." + p.name == parameter) return p.unit;
  return "";
}

int StateIndex(const Machine& machine, const std::string& name) {
  for (std::size_t i = 0; i < machine.states.states.size(); ++i)
    if (machine.states.states[i].name == name) return static_cast<int>(i);
  return -1;
}

int OutputIndex(const Machine& machine, const std::string& signal) {
  for (std::size_t i = 0; i < machine.states.outputs.size(); ++i)
    if (machine.states.outputs[i].signal == signal) return static_cast<int>(i);
  return -1;
}

}  // namespace hydroscope
