#include "models/machine_file/format.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "core/contains.h"
#include "core/units.h"
#include "models/closed_loop.h"
#include "models/machine_file/section_text.h"
#include "models/machine_file/sections.h"
#include "models/machine_file/table.h"
#include "models/machine_file/toml_text.h"
#include "models/machine_kind.h"
#include "models/source_kind.h"
#include "models/state_names.h"

namespace hydroscope {
namespace {

/// The shortest number in a unit that reads back to exactly `si`; nullopt if rounding forbids it.
std::optional<std::string> InUnit(double si, const FileUnit& unit, bool difference) {
  const double offset = difference ? 0.0 : unit.offset;
  const double value = (si - offset) / unit.scale;
  for (int digits = 1; digits <= 17; ++digits) {
    const std::string text = Plain(std::strtod(fmt::format("{:.{}g}", value, digits).c_str(), nullptr));
    if (std::strtod(text.c_str(), nullptr) * unit.scale + offset == si) return text;
  }
  return std::nullopt;
}

/// A number in the unit that the key stands in, or { value, unit } in SI where that would not read back exactly.
std::string NumberIn(double si, const std::string& unit_name, bool difference = false) {
  const FileUnit unit = FindFileUnit(unit_name).value_or(FileUnit{});
  if (const auto text = InUnit(si, unit, difference)) return *text;
  return fmt::format("{{ value = {}, unit = {} }}", Plain(si), Quoted(unit.si));
}

std::string MachineHead(const Machine& machine, const MachineNotes& notes) {
  Pairs pairs = {{"name", Quoted(machine.name)}, {"model", Quoted(std::string(KindOf(machine).id))}};
  if (!machine.description.empty()) pairs.emplace_back("description", Quoted(machine.description));
  pairs.emplace_back("model_version", Plain(machine.model_version));
  if (!machine.added_effects.empty()) {
    pairs.emplace_back("effects", QuotedList(machine.added_effects));
    if (!machine.effect_values.empty())
      pairs.emplace_back("effect_values", FormatEffectValues(machine.effect_values));
  }
  return Section("[machine]", "Machine file; every key is explained in docs/machine_file.md.", pairs, notes,
                 "machine");
}

std::string CharacterName(char c) {
  if (c == '\t') return Quoted("tab");
  if (c == ' ') return Quoted("space");
  return Quoted(std::string(1, c));
}

std::string LogSection(const LogFormat& log, const MachineNotes& notes) {
  Pairs pairs;
  if (log.separator) pairs.emplace_back("separator", CharacterName(*log.separator));
  if (log.decimal) pairs.emplace_back("decimal", CharacterName(*log.decimal));
  if (log.skip_lines) pairs.emplace_back("skip_lines", Plain(*log.skip_lines));
  if (log.header) pairs.emplace_back("header", Plain(*log.header));
  if (log.unit_row) pairs.emplace_back("unit_row", Plain(*log.unit_row));
  pairs.emplace_back("time", Inline({{"column", Quoted(log.time_column)}, {"unit", Quoted(log.time_unit)}}));
  if (log.sample_period) pairs.emplace_back("sample_period", Plain(*log.sample_period));
  if (log.hold != InputHold::kLinear)
    pairs.emplace_back("hold", Quoted(kInputHoldNames[static_cast<std::size_t>(log.hold)]));
  if (log.outputs_late) pairs.emplace_back("outputs_late", Plain(*log.outputs_late));
  return Section("[log]", "How a log is laid out; what is not said here is found by looking at the file.",
                 pairs, notes, "log");
}

std::string SignalValue(const SignalSpec& signal) {
  const SignalSpec defaults;
  Pairs pairs;
  if (!signal.origin || signal.column != signal.name) pairs.emplace_back("column", Quoted(signal.column));
  pairs.emplace_back("unit", Quoted(signal.unit));
  if (signal.scale != defaults.scale) pairs.emplace_back("scale", Plain(signal.scale));
  if (signal.offset != defaults.offset) pairs.emplace_back("offset", Plain(signal.offset));
  if (signal.min) pairs.emplace_back("min", NumberIn(*signal.min, signal.unit));
  if (signal.max) pairs.emplace_back("max", NumberIn(*signal.max, signal.unit));
  if (signal.noise_std) pairs.emplace_back("noise", NumberIn(*signal.noise_std, signal.unit, true));
  if (signal.stuck_time != defaults.stuck_time) pairs.emplace_back("stuck_time", Plain(signal.stuck_time));
  if (!signal.required) pairs.emplace_back("required", Plain(signal.required));
  if (signal.origin)
    pairs.emplace_back(signal.origin->part(),
                       FindSourceKind(signal.origin->part())->write_origin(*signal.origin));
  return Inline(pairs);
}

std::string SignalsSection(const Machine& machine, const MachineNotes& notes) {
  Pairs pairs;
  for (const SignalSpec& signal : machine.signals) {
    const auto note = notes.signals.find(signal.name);
    pairs.emplace_back(
        signal.name, SignalValue(signal) + (note == notes.signals.end() ? "" : "  " + Comment(note->second)));
  }
  return Section("[signals]",
                 "Signal of the model = column of the log, with the unit of the numbers in the log.", pairs,
                 notes, "signals");
}

template <typename Input>
std::string SiOfInput(std::span<const Input> inputs, const std::string& name) {
  for (const Input& input : inputs)
    if (input.name == name) return std::string(input.si);
  return "";
}

/// The unit people read if all values can be written in it exactly, else the SI unit; "" stays "".
std::string ReadableUnit(const std::string& si,
                         const std::vector<std::pair<double, bool>>& values_and_differences) {
  if (si.empty() || si == "1") return si;
  const std::string shown(DisplayUnitFor(si).name);
  const auto unit = FindFileUnit(shown);
  if (!unit || unit->si != si) return si;
  for (const auto& [value, difference] : values_and_differences)
    if (!InUnit(value, *unit, difference)) return si;
  return shown;
}

std::string GeometrySection(const Machine& machine, const MachineNotes& notes) {
  if (machine.geometry.empty() && !notes.section.contains("geometry")) return "";
  Pairs pairs;
  for (const auto& [name, known] : machine.geometry) {
    const std::string si = known.unit.empty() ? SiOfInput(KindOf(machine).geometry, name) : known.unit;
    const std::string unit = si == "m2" ? si : ReadableUnit(si, {{known.value, false}, {known.std, true}});
    Pairs value = {{"value", NumberIn(known.value, unit)}};
    if (known.std != 0.0) value.emplace_back("std", NumberIn(known.std, unit, true));
    if (!unit.empty()) value.emplace_back("unit", Quoted(unit));
    pairs.emplace_back(name, Inline(value));
  }
  return Section("[geometry]", "What data sheets say; std is the uncertainty.", pairs, notes, "geometry");
}

/// Bounds on signals and their rates, as ReadBounds reads them.
Pairs BoundPairs(const Machine& machine, const std::vector<GateBound>& bounds) {
  Pairs conditions;
  for (const GateBound& bound : bounds) {
    const int index = machine.SignalIndex(bound.signal);
    std::string si =
        index < 0 ? "1" : FindFileUnit(machine.signals[index].unit).value_or(FileUnit{.si = "1"}).si;
    if (bound.rate) si += "/s";
    Pairs limits;
    if (bound.min) limits.emplace_back("min", Plain(*bound.min));
    if (bound.max) limits.emplace_back("max", Plain(*bound.max));
    if (si != "1") limits.emplace_back("unit", Quoted(si));
    std::string name = bound.rate ? fmt::format("ddt({})", bound.signal) : bound.signal;
    if (bound.magnitude) name = fmt::format("abs({})", name);
    conditions.emplace_back(name, Inline(limits));
  }
  return conditions;
}

/// Of machines judged in episodes neither gate nor window need be: what is as it is anyway does not stand in their files.
std::string GateSection(const Machine& machine, const MachineNotes& notes) {
  if (InEpisodes(KindOf(machine)) && machine.gate == GateSpec{}) return "";
  const Pairs conditions = BoundPairs(machine, machine.gate.bounds);
  Pairs pairs;
  if (!conditions.empty()) pairs.emplace_back("conditions", Inline(conditions));
  pairs.emplace_back("stroke_gap", Plain(machine.gate.stroke_gap));
  pairs.emplace_back("min_stroke", Plain(machine.gate.min_stroke));
  if (machine.gate.max_stroke > 0) pairs.emplace_back("max_stroke", Plain(machine.gate.max_stroke));
  return Section("[gate]", "When the model holds: all conditions at once; times in s.", pairs, notes, "gate");
}

std::string ConditionsSection(const Machine& machine, const MachineNotes& notes) {
  if (machine.conditions.empty()) return "";
  Pairs pairs;
  for (const Condition& condition : machine.conditions)
    pairs.emplace_back(condition.name, Quoted(ConditionText(condition)));
  return Section("[conditions]",
                 "What strokes are driven at: stored with them, and strokes are told apart by it.", pairs,
                 notes, "conditions");
}

std::string WindowSection(const Machine& machine, const MachineNotes& notes) {
  const WindowSpec& window = machine.window;
  if (InEpisodes(KindOf(machine)) && window == WindowSpec{}) return "";
  return Section("[window]", "Averaging, s.",
                 {{"block", Plain(window.block)},
                  {"span", Plain(window.span)},
                  {"half_width", Plain(window.half_width)}},
                 notes, "window");
}

std::string EstimatorSection(const EstimatorSpec& spec, const MachineNotes& notes) {
  if (spec == EstimatorSpec{}) return "";
  Pairs pairs = {{"equation", Quoted(spec.equation == EquationForm::kIntegral ? "integral" : "published")},
                 {"form", Quoted(spec.form == EstimatorForm::kDirectional ? "directional" : "exponential")},
                 {"forgetting_factor", Plain(spec.forgetting_factor)},
                 {"time_constant", Plain(spec.time_constant)},
                 {"initial_covariance", Plain(spec.initial_covariance)},
                 {"initial_parameter", Plain(spec.initial_parameter)},
                 {"initial_from_first_stroke", Plain(spec.initial_from_first_stroke)},
                 {"max_covariance", Plain(spec.max_covariance)},
                 {"dead_zone", Plain(spec.dead_zone)},
                 {"clip", Plain(spec.clip)},
                 {"moving_average", Plain(spec.moving_average)},
                 {"symmetrical_derivative", Plain(spec.symmetrical_derivative)},
                 {"update_period", Plain(spec.update_period)}};
  Pairs constants;
  for (const auto& [parameter, seconds] : spec.time_constants)
    constants.emplace_back(parameter, Plain(seconds));
  if (!constants.empty()) pairs.emplace_back("time_constants", Inline(constants));
  return Section("[estimator]", "Recursive least squares; times in s.", pairs, notes, "estimator");
}

std::string MonitorSections(const Machine& machine, const MachineNotes& notes) {
  std::string text;
  for (const MonitorSpec& monitor : machine.monitors) {
    const std::array<std::pair<const char*, std::optional<double>>, 5> limits = {
        {{"reference", monitor.reference},
         {"alarm_low", monitor.alarm_low},
         {"warn_low", monitor.warn_low},
         {"warn_high", monitor.warn_high},
         {"alarm_high", monitor.alarm_high}}};
    std::vector<std::pair<double, bool>> values;
    for (const auto& [key, value] : limits)
      if (value) values.emplace_back(*value, false);
    const bool known = FindParameter(KindOf(machine), monitor.parameter) != nullptr;
    const std::string si = known || !KindOf(machine).has_states
                               ? SiOfInput(KindOf(machine).parameters, monitor.parameter)
                               : StateParameterUnit(machine, monitor.parameter);
    const std::string unit = ReadableUnit(si, values);
    Pairs pairs;
    if (!unit.empty()) pairs.emplace_back("unit", Quoted(unit));
    for (const auto& [key, value] : limits)
      if (value) pairs.emplace_back(key, NumberIn(*value, unit));
    text += Section(fmt::format("[monitor.{}]", TomlKey(monitor.parameter)), "Limits of a watched parameter.",
                    pairs, notes, "monitor." + monitor.parameter);
  }
  return text;
}

std::string ValveSection(const Machine& machine, const MachineNotes& notes) {
  const MachineKind& kind = KindOf(machine);
  const bool needs_none = kind.build != nullptr || kind.has_states || ClosedLoopOf(machine) != nullptr;
  if (machine.valve == ValveSpec{} && needs_none) return "";
  // A file with this section must have both signals; a built-in default may lack them.
  return Section("[valve]", "Frequency response: gain = output / (input / full_scale), full_scale in SI.",
                 {{"input", Quoted(machine.valve.input)},
                  {"output", Quoted(machine.valve.output)},
                  {"full_scale", Plain(machine.valve.full_scale)}},
                 notes, "valve");
}

std::string ExperimentSection(const Machine& machine, const MachineNotes& notes) {
  const ExperimentSpec& spec = machine.experiment;
  if (spec == ExperimentSpec{}) return "";
  const auto range = [](std::optional<double> min, std::optional<double> max, std::string_view unit) {
    Pairs limits;
    if (min) limits.emplace_back("min", Plain(*min));
    if (max) limits.emplace_back("max", Plain(*max));
    limits.emplace_back("unit", Quoted(std::string(unit)));
    return Inline(limits);
  };
  Pairs pairs;
  std::string title = "What the machine may be asked to do to tell effects apart";
  for (const StrokeSetting& setting : KindOf(machine).experiment.settings) {
    const auto [min, max] = spec.Of(setting.key);
    if (!setting.range) {
      pairs.emplace_back(setting.key, Plain(max.value_or(0.0)));
      title += fmt::format("; {} in {}", setting.key, setting.si);
    } else if (min || max) {
      pairs.emplace_back(setting.key, range(min, max, setting.si));
    }
  }
  if (!spec.signals.empty()) pairs.emplace_back("signals", Inline(BoundPairs(machine, spec.signals)));
  pairs.emplace_back("max_strokes", Plain(spec.max_strokes));
  return Section("[experiment]", title + ".", pairs, notes, "experiment");
}

std::string Terms(const std::vector<TermSpec>& terms) {
  Pairs pairs;
  for (const TermSpec& term : terms)
    pairs.emplace_back(term.parameter, term.unit.empty() ? Quoted(term.expression)
                                                         : Inline({{"expression", Quoted(term.expression)},
                                                                   {"unit", Quoted(term.unit)}}));
  return Inline(pairs);
}

std::string BalanceSection(const Machine& machine, const MachineNotes& notes) {
  if (machine.balance.output.empty()) return "";
  Pairs pairs = {{"output", Quoted(machine.balance.output)}};
  if (!machine.balance.unit.empty()) pairs.emplace_back("unit", Quoted(machine.balance.unit));
  pairs.emplace_back("terms", Terms(machine.balance.terms));
  if (!machine.balance.derived.empty()) pairs.emplace_back("derived", Terms(machine.balance.derived));
  return Section("[balance]", "output = sum of parameter * expression, in SI.", pairs, notes, "balance");
}

Pairs ParameterPairs(const std::vector<ParameterSpec>& parameters) {
  Pairs pairs;
  for (const ParameterSpec& p : parameters) {
    Pairs about = {{"start", Plain(p.start)}};
    if (std::isfinite(p.min)) about.emplace_back("min", Plain(p.min));
    if (std::isfinite(p.max)) about.emplace_back("max", Plain(p.max));
    if (!p.unit.empty()) about.emplace_back("unit", Quoted(p.unit));
    pairs.emplace_back(p.name, Inline(about));
  }
  return pairs;
}

std::string ParametersSection(const std::vector<ParameterSpec>& parameters, const MachineNotes& notes) {
  return parameters.empty() ? ""
                            : Section("[parameters]", "What is identified, within its range.",
                                      ParameterPairs(parameters), notes, "parameters");
}

/// Of a built-in machine: what its file says otherwise.
std::vector<ParameterSpec> OtherThanBuiltIn(const Machine& machine) {
  const std::vector<ParameterSpec> known = BuiltInStates(machine).parameters;
  std::vector<ParameterSpec> other = machine.states.parameters;
  std::erase_if(other, [&](const ParameterSpec& p) { return Contains(known, p); });
  return other;
}

std::string StatesSections(const Machine& machine, const MachineNotes& notes) {
  const StatesSpec& spec = machine.states;
  if (spec.states.empty()) return "";
  if (KindOf(machine).states != nullptr) return ParametersSection(OtherThanBuiltIn(machine), notes);
  Pairs states, outputs;
  for (const StateSpec& s : spec.states) {
    Pairs about = {{"ddt", Quoted(s.ddt)}, {"initial", Quoted(s.initial)}};
    if (!s.near.empty()) about.emplace_back("near", Quoted(s.near));
    if (!s.min.empty()) about.emplace_back("min", Quoted(s.min));
    if (!s.max.empty()) about.emplace_back("max", Quoted(s.max));
    if (!s.unit.empty()) about.emplace_back("unit", Quoted(s.unit));
    states.emplace_back(s.name, Inline(about));
  }
  for (const OutputSpec& o : spec.outputs) outputs.emplace_back(o.signal, Quoted(o.expression));
  return Section("[states]", "d state / dt = ddt, in SI.", states, notes, "states") +
         Section("[outputs]", "Measured signals as the model gives them.", outputs, notes, "outputs") +
         ParametersSection(spec.parameters, notes);
}

std::string EpisodeSection(const Machine& machine, const MachineNotes& notes) {
  Pairs pairs;
  if (machine.states.episode_seconds) pairs.emplace_back("seconds", Plain(*machine.states.episode_seconds));
  if (!machine.states.shaft.empty()) pairs.emplace_back("shaft", Quoted(machine.states.shaft));
  if (!machine.episode_marker.empty()) pairs.emplace_back("marker", Quoted(machine.episode_marker));
  return pairs.empty()
             ? ""
             : Section("[episodes]", "A continuous log is cut into pieces.", pairs, notes, "episodes");
}

std::string EffectSections(const Machine& machine, const MachineNotes& notes) {
  std::string text;
  for (const UserEffectSpec& effect : machine.user_effects) {
    Pairs pairs = {{"id", Quoted(effect.id)}};
    if (!effect.description.empty()) pairs.emplace_back("description", Quoted(effect.description));
    if (!effect.german.empty()) pairs.emplace_back("german", Quoted(effect.german));
    if (!effect.terms.empty()) pairs.emplace_back("terms", Terms(effect.terms));
    if (!effect.adds.empty()) pairs.emplace_back("adds", Terms(effect.adds));
    if (!effect.parameters.empty())
      pairs.emplace_back("parameters", Inline(ParameterPairs(effect.parameters)));
    if (effect.min) pairs.emplace_back("min", Plain(*effect.min));
    if (effect.max) pairs.emplace_back("max", Plain(*effect.max));
    if (effect.typical) pairs.emplace_back("typical", Plain(*effect.typical));
    Pairs shape;
    for (const ShapeSpec& s : effect.shape) {
      Pairs limits = {{"min", Plain(s.min)}, {"max", Plain(s.max)}};
      if (!s.unit.empty()) limits.emplace_back("unit", Quoted(s.unit));
      shape.emplace_back(s.name, Inline(limits));
    }
    if (!shape.empty()) pairs.emplace_back("shape", Inline(shape));
    text += Section("[[effect]]", "An effect that may be missing in the balance.", pairs, notes, "effect");
  }
  return text;
}

}  // namespace

std::string FormatMachine(const Machine& machine, const MachineNotes& notes) {
  std::string text;
  for (const std::string& line : notes.head) text += Comment(line) + "\n";
  text += MachineHead(machine, notes) + LogSection(machine.log, notes) + SignalsSection(machine, notes) +
          GeometrySection(machine, notes) + GateSection(machine, notes) + ConditionsSection(machine, notes) +
          WindowSection(machine, notes) + EstimatorSection(machine.estimator, notes) +
          MonitorSections(machine, notes) + ValveSection(machine, notes) + ExperimentSection(machine, notes) +
          BalanceSection(machine, notes) + StatesSections(machine, notes) + EpisodeSection(machine, notes) +
          EffectSections(machine, notes) + LiveSections(machine, notes) + FeedsSections(machine, notes);
  for (const std::string& line : notes.tail) text += Comment(line) + "\n";
  if (notes.tail.empty()) text.pop_back();
  return text + FormatModelHistory(machine.model_history);
}

std::string FormatMachine(const Machine& machine) { return FormatMachine(machine, MachineNotes{}); }

}  // namespace hydroscope
