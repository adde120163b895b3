#include <algorithm>
#include <cmath>

#include "core/limits.h"
#include "models/machine_file/keys.h"
#include "models/machine_file/sections.h"
#include "models/machine_kind.h"
#include "models/state_names.h"

namespace hydroscope {
namespace {

/// A unit that the file may name, or any SI unit; a problem if it is neither.
FileUnit ReadAnyUnit(TableReader& reader) {
  std::string unit;
  reader.Text("unit", unit);
  if (unit.empty()) return {};
  if (const auto known = FindFileUnit(unit)) return *known;
  if (!ParseSiUnit(unit))
    reader.Wrong("unit", "a unit of docs/machine_file.md, or an SI unit such as \"N s/m\"");
  return {.si = unit};
}

/// A number in `unit`, or an expression in SI; "" if the key is not there.
void ReadNumberOrText(TableReader& reader, const char* key, const FileUnit& unit, std::string& text) {
  if (!reader.Has(key)) return;
  const toml::node& node = *reader.Node(key);
  if (const auto number = node.value<double>(); number && !node.is_string() && std::isfinite(*number))
    text = fmt::format("{}", *number * unit.scale + unit.offset);
  else if (node.is_string())
    text = node.as_string()->get();
  else
    reader.Wrong(key, "a number, or an expression in quotes");
}

/// Parses and checks an expression of this section; problems point at its character.
void CheckText(TableReader& reader, const std::string& key, const std::string& text,
               const ExpressionNames& names, const std::string& unit) {
  const toml::node* node = reader.Node(key);
  if (node == nullptr || !node->is_string() || text.empty()) return;
  const auto checked = CheckExpression(text, names);
  if (!checked) {
    ExpressionProblem(reader, *node, key, checked.error());
    return;
  }
  if (ContainsDdt(*checked->tree))
    ExpressionProblem(
        reader, *node, key,
        {text.find("ddt"),
         {"ddt(...) has no place here: make what changes a state of its own, or give its rate as a signal",
          "ddt(...) hat hier keinen Platz: was sich ändert, zu einem eigenen Zustand machen, oder seine "
          "Änderungsrate als Signal geben"}});
  const auto expected = ParseSiUnit(unit);
  if (expected && checked->unit.exact && !(checked->unit.dimension == *expected))
    reader.Wrong(key, fmt::format("an expression in {}, this one is in {}", SiUnitName(*expected),
                                  SiUnitName(checked->unit.dimension)));
}

std::string PerSecond(const std::string& unit) {
  const auto dimension = ParseSiUnit(unit);
  return dimension ? SiUnitName(*dimension / *ParseSiUnit("s")) : "";
}

/// A name that nothing else in the file has.
void CheckName(TableReader& reader, const TableReader::Entry& entry, const Machine& machine,
               const char* what) {
  if (IsName(entry.key) && entry.key != "pi" && machine.SignalIndex(entry.key) < 0) return;
  reader.Problem(entry.where, fmt::format("\"{}\" is no name for a {}: letters, digits and _ only, no digit "
                                          "first, and no signal of that name",
                                          entry.key, what));
}

/// Start and range as the file says, `p` where it says nothing; `p.start` is known if `known`.
void ReadParameter(TableReader& reader, bool known, ParameterSpec& p) {
  if (reader.Has("value")) {
    reader.Wrong(
        "value",
        "no such key: parameters are found from the log, and what is known stands in [geometry], e.g. "
        "m = { value = 25, unit = \"kg\" }");
    return;
  }
  reader.AllowOnly(MachineFileKeys("parameters.<name>"));
  FileUnit unit = ReadAnyUnit(reader);
  if (!known) p.unit = unit.si;
  if (known && reader.Has("unit") && !p.unit.empty() && ParseSiUnit(unit.si) != ParseSiUnit(p.unit))
    reader.Wrong("unit", fmt::format("{} or a unit of the same quantity", p.unit));
  std::optional<double> start, min, max;
  reader.Number("start", start, {.si = ""});
  reader.Number("min", min, {.si = ""});
  reader.Number("max", max, {.si = ""});
  const auto si = [&](double value) { return value * unit.scale + unit.offset; };
  if (min) p.min = si(*min);
  if (max) p.max = si(*max);
  if ((min || max) && !(p.min < p.max)) reader.Wrong(min ? "min" : "max", "a limit below max");
  if (start)
    p.start = si(*start);
  else if (known && p.start >= p.min && p.start <= p.max)
    return;
  else if (std::isfinite(p.min) && std::isfinite(p.max))
    p.start = p.min > 0 ? std::sqrt(p.min * p.max) : 0.5 * (p.min + p.max);
  else
    reader.Problem("start is missing; write e.g. { start = 0.1, min = 0.01, max = 1 }");
  if (p.start < p.min || p.start > p.max) reader.Wrong("start", "a value between min and max");
}

std::vector<ParameterSpec> ReadParameters(TableReader& section, const std::string& key,
                                          const Machine& machine) {
  std::vector<ParameterSpec> parameters;
  const toml::table* table = section.Table(key);
  if (table == nullptr) return parameters;
  TableReader reader(*table, section.path().empty() ? key : section.path() + "." + key, section.problems());
  for (const TableReader::Entry& entry : reader.Entries()) {
    CheckName(reader, entry, machine, "parameter");
    if (StateIndex(machine, entry.key) >= 0) reader.Wrong(entry.key, "another name: a state is called so");
    const toml::table* about = reader.Table(entry.key);
    if (about == nullptr) continue;
    TableReader inner(*about, reader.path() + "." + entry.key, section.problems());
    ParameterSpec p;
    p.name = entry.key;
    ReadParameter(inner, false, p);
    parameters.push_back(std::move(p));
  }
  return parameters;
}

/// Start and range of parameters of a built-in machine, where the file says them.
void ReadKnownParameters(TableReader& file, std::vector<ParameterSpec>& parameters) {
  const toml::table* table = file.Table("parameters");
  if (table == nullptr) return;
  TableReader reader(*table, "parameters", file.problems());
  std::vector<std::string> names;
  for (const ParameterSpec& p : parameters) names.push_back(p.name);
  reader.AllowOnly(names);
  for (ParameterSpec& p : parameters)
    if (const toml::table* about = reader.Has(p.name) ? reader.Table(p.name) : nullptr) {
      TableReader inner(*about, "parameters." + p.name, file.problems());
      ReadParameter(inner, true, p);
    }
}

/// The number that a text is, if it is no expression.
std::optional<double> NumberOf(const std::string& text) {
  const auto tree = ParseExpression(text);
  if (!tree) return std::nullopt;
  const ExpressionNode& node = (*tree)->kind == ExpressionNode::Kind::kNegate ? *(*tree)->args[0] : **tree;
  if (node.kind != ExpressionNode::Kind::kNumber) return std::nullopt;
  return &node == tree->get() ? node.number : -node.number;
}

void CheckLimits(TableReader& reader, const StateSpec& state) {
  const auto initial = NumberOf(state.initial), min = NumberOf(state.min), max = NumberOf(state.max);
  if (min && max && !(*min < *max)) reader.Wrong("min", "a limit below max");
  if (initial && ((min && *initial < *min) || (max && *initial > *max)))
    reader.Wrong("initial", "a value between min and max");
}

void ReadState(TableReader& reader, StateSpec& state) {
  reader.AllowOnly(MachineFileKeys("states.<name>"));
  const FileUnit unit = ReadAnyUnit(reader);
  state.unit = unit.si;
  reader.Text("ddt", state.ddt);
  if (state.ddt.empty())
    reader.Problem("this state has no equation; write e.g. ddt = \"(q_in - k1*sqrt(h_1))/A1\"");
  ReadNumberOrText(reader, "min", unit, state.min);
  ReadNumberOrText(reader, "max", unit, state.max);
  ReadNumberOrText(reader, "initial", unit, state.initial);
  ReadNumberOrText(reader, "near", unit, state.near);
  if (state.initial.empty()) state.initial = "estimate";
  if (!state.near.empty() && state.initial != "estimate")
    reader.Wrong("near",
                 "no such key beside initial: it says where the search for an unknown initial value begins");
  CheckLimits(reader, state);
}

/// The first output that an expression names, "" = none.
std::string OutputIn(const std::string& text, const Machine& machine) {
  if (const auto tree = ParseExpression(text))
    for (const std::string& name : NamesIn(**tree))
      if (OutputIndex(machine, name) >= 0) return name;
  return "";
}

/// What needs all names of the file.
void CheckStates(TableReader& file, const Machine& machine) {
  const ExpressionNames names = StateNamesOf(machine), limits = LimitNamesOf(machine),
                        initial = InitialNamesOf(machine);
  TableReader states(*file.Table("states"), "states", file.problems());
  for (const StateSpec& s : machine.states.states) {
    const toml::table* table = states.Table(s.name);
    if (table == nullptr) continue;
    TableReader reader(*table, "states." + s.name, file.problems());
    if (const std::string output = OutputIn(s.ddt, machine); !output.empty())
      reader.Wrong(
          "ddt",
          fmt::format("an expression of states, inputs and parameters; {} is an output, which the model "
                      "gives itself: name the state that it shows",
                      output));
    else
      CheckText(reader, "ddt", s.ddt, names, PerSecond(s.unit));
    CheckText(reader, "min", s.min, limits, s.unit);
    CheckText(reader, "max", s.max, limits, s.unit);
    if (s.initial != "estimate") CheckText(reader, "initial", s.initial, initial, s.unit);
    CheckText(reader, "near", s.near, initial, s.unit);
  }
  const toml::table* table = file.Table("outputs");
  if (table == nullptr) return;
  TableReader outputs(*table, "outputs", file.problems());
  for (const OutputSpec& o : machine.states.outputs) {
    if (const std::string loop = OutputIn(o.expression, machine); !loop.empty()) {
      outputs.Wrong(o.signal,
                    fmt::format("an expression of states, inputs and parameters; {} is an output itself, and "
                                "would explain itself (an algebraic loop)",
                                loop));
      continue;
    }
    const int signal = machine.SignalIndex(o.signal);
    CheckText(outputs, o.signal, o.expression, names,
              signal < 0 ? "" : SiOf(machine.signals[static_cast<std::size_t>(signal)].unit));
  }
}

/// The equations of a built-in machine. They may name all that its kind requires: that is asked for first.
void ReadBuiltInStates(TableReader& file, Machine& machine) {
  const MachineKind& kind = KindOf(machine);
  if (file.Has("outputs")) file.Wrong("outputs", fmt::format("no such section: \"{}\" has its own", kind.id));
  if (!file.problems().any()) CheckModelInputs(file, machine);
  if (file.problems().any()) return;
  machine.states = BuiltInStates(machine);
  if (machine.states.outputs.empty())
    file.Problem(fmt::format("model \"{}\" needs a signal in [signals] that it gives", kind.id));
  ReadKnownParameters(file, machine.states.parameters);
}

}  // namespace

void ReadStates(TableReader& file, Machine& machine) {
  if (KindOf(machine).states != nullptr) return ReadBuiltInStates(file, machine);
  if (!KindOf(machine).has_states) {
    for (const char* key : {"states", "outputs", "parameters"})
      if (file.Has(key)) file.Wrong(key, "no such section without [states]");
    return;
  }
  const toml::table* table = file.Table("states");
  if (table == nullptr || table->empty()) {
    file.Problem("model \"" + machine.model + "\" needs a section [states] with an equation for each state");
    return;
  }
  TableReader section(*table, "states", file.problems());
  for (const TableReader::Entry& entry : section.Entries()) {
    CheckName(section, entry, machine, "state");
    StateSpec state;
    state.name = entry.key;
    if (const toml::table* about = section.Table(entry.key)) {
      TableReader reader(*about, "states." + entry.key, file.problems());
      ReadState(reader, state);
    }
    machine.states.states.push_back(std::move(state));
  }
  machine.states.parameters = ReadParameters(file, "parameters", machine);
  const toml::table* outputs = file.Table("outputs");
  if (outputs == nullptr || outputs->empty()) {
    file.Problem(
        "section [outputs] is missing; write e.g. level_2 = \"h_2\": a signal that "
        "is measured = what the model gives for it");
    return;
  }
  TableReader reader(*outputs, "outputs", file.problems());
  for (const TableReader::Entry& entry : reader.Entries()) {
    OutputSpec output{entry.key, ""};
    reader.Text(entry.key, output.expression);
    if (machine.SignalIndex(entry.key) < 0)
      reader.Problem(
          entry.where,
          fmt::format("\"{}\" is no signal of [signals]; an output is a measured signal", entry.key));
    machine.states.outputs.push_back(std::move(output));
  }
  const std::size_t parameters = machine.states.parameters.size();
  if (parameters > kMaxParameters)
    file.Problem(
        fmt::format("[parameters] holds {}, at most {} can be fitted at once", parameters, kMaxParameters));
  if (machine.states.states.size() > kMaxStates)
    file.Problem(
        fmt::format("[states] holds {} states, at most {}", machine.states.states.size(), kMaxStates));
  CheckStates(file, machine);
}

void ReadStateEffect(TableReader& section, const Machine& machine, UserEffectSpec& effect) {
  for (const char* key : {"terms", "shape", "unit", "min", "max", "typical"})
    if (section.Has(key))
      section.Wrong(key,
                    "no such key in a model with states: write adds = { state = \"...\" } and parameters");
  effect.parameters = ReadParameters(section, "parameters", machine);
  for (const ParameterSpec& p : effect.parameters)
    for (const ParameterSpec& known : machine.states.parameters)
      if (p.name == known.name) section.Wrong("parameters", "names that [parameters] has not");
  const toml::table* table = section.Table("adds");
  if (table == nullptr || table->empty()) {
    section.Problem("adds is missing; write e.g. adds = { h_1 = \"-k3*max(h_1 - h_max, 0)\" }");
    return;
  }
  const ExpressionNames names = StateNamesOf(machine, effect.parameters);
  TableReader reader(*table, section.path() + ".adds", section.problems());
  for (const TableReader::Entry& entry : reader.Entries()) {
    TermSpec term{entry.key, "", ""};
    reader.Text(entry.key, term.expression);
    const int state = StateIndex(machine, entry.key), output = OutputIndex(machine, entry.key);
    if (state < 0 && output < 0)
      reader.Problem(entry.where, fmt::format("\"{}\" is neither a state nor an output", entry.key));
    else if (state >= 0)
      CheckText(reader, entry.key, term.expression, names,
                PerSecond(machine.states.states[static_cast<std::size_t>(state)].unit));
    else
      CheckText(reader, entry.key, term.expression, names, "");
    effect.adds.push_back(std::move(term));
  }
}

}  // namespace hydroscope
