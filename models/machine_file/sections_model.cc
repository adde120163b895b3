#include <algorithm>

#include "models/closed_loop.h"
#include "models/machine_file/keys.h"
#include "models/machine_file/sections.h"
#include "models/machine_kind.h"
#include "models/state_names.h"

namespace hydroscope {
namespace {

std::vector<std::string> SignalNames(const Machine& machine) {
  std::vector<std::string> names;
  for (const SignalSpec& signal : machine.signals) names.push_back(signal.name);
  return names;
}

/// A signal that differs from one of the model's only in case is a slip of the pen.
bool SameButCase(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

/// Signals that are none of the model's: one of them may be a misspelt one.
std::vector<std::string> OwnSignalNames(const Machine& machine, const MachineKind& model) {
  std::vector<std::string> names;
  for (const SignalSpec& signal : machine.signals)
    if (std::none_of(model.signals.begin(), model.signals.end(),
                     [&](const MachineInput& input) { return input.name == signal.name; }))
      names.push_back(signal.name);
  return names;
}

void CheckModelSignals(TableReader& file, const Machine& machine, const MachineKind& model) {
  const toml::table* table = file.Table("signals");
  if (table == nullptr || table->empty()) {
    file.Problem("section [signals] is missing: it says which column of the log is which signal");
    return;
  }
  TableReader section(*table, "signals", file.problems());
  for (const MachineInput& input : model.signals) {
    const int index = machine.SignalIndex(std::string(input.name));
    if (index >= 0) {
      const std::string si = SiOf(machine.signals[index].unit);
      if (si != input.si)
        section.Wrong(input.name,
                      fmt::format("a signal in {} or a unit of the same quantity ({}), found unit \"{}\"{}",
                                  input.si, input.meaning, machine.signals[index].unit,
                                  input.si == "rad/s" && si == "1/s" ? "; did you mean \"rpm\"?" : ""));
      continue;
    }
    for (const SignalSpec& signal : machine.signals)
      if (SameButCase(signal.name, input.name))
        section.Wrong(signal.name, fmt::format("the spelling {} ({})", input.name, input.meaning));
    if (input.required)
      section.Problem(fmt::format(
          "{} is missing: model \"{}\" needs the {}; {}write e.g. {} = {{ column = \"...\", unit = \"{}\" }}",
          input.name, model.id, input.meaning, DidYouMean(input.name, OwnSignalNames(machine, model)).english,
          input.name, input.si));
  }
}

void CheckModelGeometry(TableReader& file, const Machine& machine, const MachineKind& model) {
  const toml::table* table = file.Table("geometry");
  for (const MachineInput& input : model.geometry) {
    if (!input.required || machine.Geometry(std::string(input.name))) continue;
    const std::string text = fmt::format(
        "{} is missing: model \"{}\" needs the {}; write e.g. {} = {{ value = ..., unit = \"{}\" }}",
        input.name, model.id, input.meaning, input.name, input.si);
    if (table == nullptr)
      file.Problem("[geometry] " + text);
    else
      TableReader(*table, "geometry", file.problems()).Problem(text);
  }
}

void CheckValveSignals(TableReader& file, const Machine& machine) {
  const MachineKind& kind = KindOf(machine);
  const bool needs_none = kind.build != nullptr || kind.has_states || ClosedLoopOf(machine) != nullptr;
  if (needs_none && !file.Has("valve")) return;
  for (const std::string& name : {machine.valve.input, machine.valve.output}) {
    if (machine.SignalIndex(name) >= 0) continue;
    file.Problem(fmt::format("[valve] signal {} is not in [signals]; {}signals: {}", name,
                             DidYouMean(name, SignalNames(machine)).english, Listed(SignalNames(machine))));
  }
}

}  // namespace

void ReadMonitors(TableReader& file, Machine& machine) {
  const toml::table* table = file.Table("monitor");
  if (table == nullptr) return;
  const MachineKind& model = KindOf(machine);
  TableReader section(*table, "monitor", file.problems());
  for (const TableReader::Entry& entry : section.Entries()) {
    const toml::table* limits = section.Table(entry.key);
    if (limits == nullptr) continue;
    TableReader reader(*limits, "monitor." + entry.key, file.problems());
    reader.AllowOnly(MachineFileKeys("monitor.<parameter>"));
    const MachineParameter* parameter = FindParameter(model, entry.key);
    const std::string si = parameter != nullptr ? std::string(parameter->si)
                           : model.has_states   ? StateParameterUnit(machine, entry.key)
                                                : "";
    std::string unit = si;
    reader.UnitName("unit", unit, si);
    const Quantity quantity{.si = si, .default_unit = unit};
    MonitorSpec spec;
    spec.parameter = entry.key;
    reader.Number("reference", spec.reference, quantity);
    reader.Number("alarm_low", spec.alarm_low, quantity);
    reader.Number("warn_low", spec.warn_low, quantity);
    reader.Number("warn_high", spec.warn_high, quantity);
    reader.Number("alarm_high", spec.alarm_high, quantity);
    std::optional<double> below;
    for (const auto& [key, limit] :
         {std::pair("alarm_low", spec.alarm_low), std::pair("warn_low", spec.warn_low),
          std::pair("warn_high", spec.warn_high), std::pair("alarm_high", spec.alarm_high)}) {
      if (limit && below && *limit < *below)
        reader.Wrong(key, "limits in the order alarm_low <= warn_low <= warn_high <= alarm_high");
      if (limit) below = limit;
    }
    machine.monitors.push_back(std::move(spec));
  }
}

void ReadValve(TableReader& file, Machine& machine) {
  const toml::table* table = file.Table("valve");
  if (table == nullptr) return;
  TableReader section(*table, "valve", file.problems());
  section.AllowOnly(MachineFileKeys("valve"));
  section.Text("input", machine.valve.input);
  section.Text("output", machine.valve.output);
  const int input = machine.SignalIndex(machine.valve.input);
  const std::string si = input < 0 ? "" : SiOf(machine.signals[input].unit);
  section.Number("full_scale", machine.valve.full_scale, {.si = si, .low = 0, .above_low = true});
}

void CheckModelInputs(TableReader& file, const Machine& machine) {
  const MachineKind& model = KindOf(machine);
  CheckModelSignals(file, machine, model);
  CheckModelGeometry(file, machine, model);
}

void CheckMachine(TableReader& file, const Machine& machine) {
  if (KindOf(machine).states == nullptr) CheckModelInputs(file, machine);  // else ReadStates has asked
  CheckValveSignals(file, machine);
  CheckLive(file, machine);
}

}  // namespace hydroscope
