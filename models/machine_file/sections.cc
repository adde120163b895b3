#include "models/machine_file/sections.h"

#include <algorithm>
#include <charconv>
#include <set>

#include "core/units.h"
#include "models/machine_file/keys.h"
#include "models/machine_kind.h"

namespace hydroscope {

std::string SiOf(const std::string& unit) { return FindFileUnit(unit).value_or(FileUnit{.si = "1"}).si; }

namespace {

const Quantity kSeconds{.si = "s", .default_unit = "s", .low = 0};

/// A section that is a table of its own; calls `read` with its reader if it is there.
template <typename Read>
void ReadSection(TableReader& file, const std::string& name, const Read& read) {
  const toml::table* table = file.Table(name);
  if (table == nullptr) return;
  TableReader section(*table, name, file.problems());
  read(section);
}

bool IsColumnNumber(const std::string& column) {
  int number = 0;
  const auto [end, error] = std::from_chars(column.data(), column.data() + column.size(), number);
  return error == std::errc() && end == column.data() + column.size() && number >= 1;
}

/// A column by its name, or by its number (3 or "3"); false if it is neither.
bool ReadColumn(TableReader& reader, const toml::node& node, std::string_view key, std::string& column) {
  if (node.is_string()) {
    column = node.as_string()->get();
    return true;
  }
  if (node.is_integer() && node.as_integer()->get() >= 1) {
    column = std::to_string(node.as_integer()->get());
    return true;
  }
  reader.Wrong(key, "a column name in quotes, or a column number from 1 up");
  return false;
}

void ReadSignalColumn(TableReader& reader, const toml::node& node, std::string_view key, const LogFormat& log,
                      std::string& column) {
  if (!ReadColumn(reader, node, key, column)) return;
  if (column.empty()) reader.Wrong(key, "the name of a column of the log");
  if (!column.empty() && log.header == false && !IsColumnNumber(column))
    reader.Wrong(key, "a column number from 1 up, because [log] header = false");
}

void ReadTimeColumn(TableReader& section, const toml::table& table, LogFormat& log) {
  const toml::table* time = table.get_as<toml::table>("time");
  if (time == nullptr) {
    ReadColumn(section, *table.get("time"), "time", log.time_column);
    return;
  }
  TableReader reader(*time, "log.time", section.problems());
  reader.AllowOnly(MachineFileKeys("log.time"));
  if (const toml::node* column = time->get("column")) ReadColumn(reader, *column, "column", log.time_column);
  reader.UnitName("unit", log.time_unit, "s");
}

std::optional<char> ReadCharacter(TableReader& reader, std::string_view key,
                                  const std::vector<std::pair<std::string, char>>& choices) {
  std::vector<std::string> names;
  for (const auto& [name, character] : choices) names.push_back(name);
  const auto choice = reader.Choice(key, names);
  if (!choice) return std::nullopt;
  return choices[*choice].second;
}

void ReadSignal(TableReader& signal, const toml::table& table, const LogFormat& log, SignalSpec& spec) {
  signal.AllowOnly(MachineFileKeys("signals.<name>"));
  if (const toml::node* column = table.get("column"))
    ReadSignalColumn(signal, *column, "column", log, spec.column);
  ReadSignalOrigin(signal, spec);
  if (spec.origin && !signal.Has("column")) spec.column = spec.name;
  if (!spec.origin && !signal.Has("column"))
    signal.Problem("column is missing; write e.g. { column = \"pressure_A\", unit = \"bar\" }");
  signal.UnitName("unit", spec.unit, "");
  signal.Number("scale", spec.scale, {.si = ""});
  if (spec.scale == 0.0) signal.Wrong("scale", "a number other than 0");
  signal.Number("offset", spec.offset, {.si = ""});
  const std::string si = SiOf(spec.unit);
  signal.Number("min", spec.min, {.si = si, .default_unit = spec.unit});
  signal.Number("max", spec.max, {.si = si, .default_unit = spec.unit});
  if (spec.min && spec.max && *spec.min > *spec.max) signal.Wrong("min", "a limit not above max");
  signal.Number("noise", spec.noise_std,
                {.si = si, .default_unit = spec.unit, .difference = true, .low = 0, .above_low = true});
  signal.Number("stuck_time", spec.stuck_time, kSeconds);
  signal.Flag("required", spec.required);
}

/// Takes "abs(" ... ")" off; false if `text` is not so wrapped.
bool Unwrap(std::string_view wrapper, std::string& text) {
  if (!text.starts_with(wrapper) || !text.ends_with(")")) return false;
  text = text.substr(wrapper.size(), text.size() - wrapper.size() - 1);
  return true;
}

/// Names are used in expressions: letters, digits and _, not starting with a digit.
bool IsIdentifier(const std::string& name) {
  const auto word = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  };
  return !name.empty() && !(name[0] >= '0' && name[0] <= '9') && std::all_of(name.begin(), name.end(), word);
}

}  // namespace

void ReadMachineSection(TableReader& file, Machine& machine) {
  const std::string own(OwnKind().id), states(OwnStatesKind().id);
  machine.model = KindNames().front();
  if (file.Has("balance")) machine.model = own;
  if (file.Has("states")) machine.model = states;
  ReadSection(file, "machine", [&](TableReader& section) {
    section.AllowOnly(MachineFileKeys("machine"));
    section.Text("name", machine.name);
    section.Text("description", machine.description);
    section.Integer("model_version", machine.model_version, 1);
    if (const auto model = section.Choice("model", KindNames())) {
      if (file.Has("balance") && KindNames()[*model] != own)
        section.Wrong("model", "\"" + own + "\", because the file has its own [balance]");
      if (file.Has("states") && KindNames()[*model] != states)
        section.Wrong("model", "\"" + states + "\", because the file has its own [states]");
      machine.model = KindNames()[*model];
    }
    section.Texts("effects", machine.added_effects);
    ReadEffectValues(section, machine);
    const std::set<std::string> once(machine.added_effects.begin(), machine.added_effects.end());
    if (once.size() != machine.added_effects.size()) section.Wrong("effects", "every effect only once");
  });
}

void ReadLogSection(TableReader& file, Machine& machine) {
  LogFormat& log = machine.log;
  ReadSection(file, "log", [&](TableReader& section) {
    section.AllowOnly(MachineFileKeys("log"));
    log.separator =
        ReadCharacter(section, "separator",
                      {{",", ','}, {";", ';'}, {"tab", '\t'}, {"\t", '\t'}, {"space", ' '}, {" ", ' '}});
    log.decimal = ReadCharacter(section, "decimal", {{".", '.'}, {",", ','}});
    if (log.separator && log.separator == log.decimal)
      section.Wrong("decimal", "another sign than the separator");
    if (section.Has("skip_lines")) section.Integer("skip_lines", log.skip_lines.emplace(0), 0);
    if (section.Has("header")) section.Flag("header", log.header.emplace(true));
    if (section.Has("unit_row")) section.Flag("unit_row", log.unit_row.emplace(false));
    section.Number("sample_period", log.sample_period, kSecondsAboveZero);
    if (const auto hold = section.Choice("hold", {kInputHoldNames.begin(), kInputHoldNames.end()}))
      log.hold = static_cast<InputHold>(*hold);
    section.Number("outputs_late", log.outputs_late, Quantity{.si = "s"});
    if (section.Has("time")) ReadTimeColumn(section, *file.Table("log"), log);
    if (log.time_column.empty() && !log.sample_period)
      section.Wrong("time", "a column, or sample_period = <seconds between rows> beside it");
    if (log.header == false && !log.time_column.empty() && !IsColumnNumber(log.time_column))
      section.Wrong("time", "a column number from 1 up, because header = false");
  });
}

void ReadSignals(TableReader& file, Machine& machine) {
  ReadSection(file, "signals", [&](TableReader& section) {
    for (const TableReader::Entry& entry : section.Entries()) {
      SignalSpec spec;
      spec.name = entry.key;
      if (!IsIdentifier(entry.key))
        section.Problem(
            entry.where,
            fmt::format("\"{}\" is no signal name: letters, digits and _ only, no digit first", entry.key));
      if (const toml::table* table = entry.node->as_table()) {
        TableReader signal(*table, "signals." + entry.key, section.problems());
        ReadSignal(signal, *table, machine.log, spec);
      } else {
        ReadSignalColumn(section, *entry.node, entry.key, machine.log, spec.column);
      }
      machine.signals.push_back(std::move(spec));
    }
  });
}

void ReadGeometry(TableReader& file, Machine& machine) {
  const MachineKind& model = KindOf(machine);
  ReadSection(file, "geometry", [&](TableReader& section) {
    std::vector<std::string> known;
    for (const MachineInput& input : model.geometry) known.emplace_back(input.name);
    if (!known.empty()) section.AllowOnly(known);
    for (const TableReader::Entry& entry : section.Entries()) {
      const auto input = std::find_if(model.geometry.begin(), model.geometry.end(),
                                      [&](const MachineInput& i) { return i.name == entry.key; });
      const bool is_known = input != model.geometry.end();
      const std::string si(is_known ? input->si : "");
      KnownValue& value = machine.geometry[entry.key];
      Quantity quantity{.si = si};
      if (is_known && input->positive) {
        quantity.low = 0;
        quantity.above_low = true;
      }
      const toml::table* table = entry.node->as_table();
      if (table == nullptr) {
        section.Number(entry.key, value.value, quantity);
        continue;
      }
      TableReader reader(*table, "geometry." + entry.key, section.problems());
      reader.AllowOnly(MachineFileKeys("geometry.<name>"));
      std::string unit = si;
      reader.UnitName("unit", unit, si);
      quantity.default_unit = unit;
      if (!is_known && !unit.empty()) value.unit = SiOf(unit);
      if (!reader.Has("value"))
        reader.Problem("value is missing; write e.g. { value = 125, unit = \"cm2\" }");
      reader.Number("value", value.value, quantity);
      reader.Number("std", value.std, {.si = si, .default_unit = unit, .difference = true, .low = 0});
    }
  });
}

std::vector<GateBound> ReadBounds(TableReader& section, std::string_view key, const std::string& path,
                                  const Machine& machine) {
  std::vector<GateBound> bounds;
  const toml::table* table = section.Table(key);
  if (table == nullptr) return bounds;
  TableReader conditions(*table, path, section.problems());
  std::vector<std::string> names;
  for (const SignalSpec& signal : machine.signals) names.push_back(signal.name);
  for (const TableReader::Entry& entry : conditions.Entries()) {
    GateBound bound;
    bound.signal = entry.key;
    bound.magnitude = Unwrap("abs(", bound.signal);
    bound.rate = Unwrap("ddt(", bound.signal);
    const int index = machine.SignalIndex(bound.signal);
    if (index < 0) {
      conditions.Problem(
          entry.where,
          fmt::format(
              "\"{}\" is no signal; {}signals: {}; rates: \"ddt(<signal>)\", magnitudes: \"abs(...)\"",
              bound.signal, DidYouMean(bound.signal, names).english, Listed(names)));
      continue;
    }
    const toml::table* limits = conditions.Table(entry.key);
    if (limits == nullptr) continue;
    TableReader reader(*limits, path + "." + entry.key, section.problems());
    reader.AllowOnly(MachineFileKeys("gate.conditions.<signal>"));
    std::string unit = SiOf(machine.signals[index].unit);
    if (bound.rate) unit = FindFileUnit(unit + "/s").value_or(FileUnit{.si = unit + "/s"}).si;
    const std::string si = unit;
    reader.UnitName("unit", unit, si);
    const Quantity quantity{.si = si, .default_unit = unit};
    reader.Number("min", bound.min, quantity);
    reader.Number("max", bound.max, quantity);
    if (!reader.Has("min") && !reader.Has("max")) reader.Problem("min or max is missing");
    if (bound.min && bound.max && *bound.min > *bound.max) reader.Wrong("min", "a limit not above max");
    bounds.push_back(std::move(bound));
  }
  return bounds;
}

void ReadGate(TableReader& file, Machine& machine) {
  ReadSection(file, "gate", [&](TableReader& section) {
    section.AllowOnly(MachineFileKeys("gate"));
    section.Number("stroke_gap", machine.gate.stroke_gap, kSecondsAboveZero);
    section.Number("min_stroke", machine.gate.min_stroke, kSecondsAboveZero);
    section.Number("max_stroke", machine.gate.max_stroke, kSecondsAboveZero);
    if (section.Has("max_stroke") && machine.gate.max_stroke < machine.gate.min_stroke)
      section.Wrong("max_stroke", fmt::format("not less than min_stroke, {} s", machine.gate.min_stroke));
    machine.gate.bounds = ReadBounds(section, "conditions", "gate.conditions", machine);
  });
}

void ReadWindow(TableReader& file, Machine& machine) {
  ReadSection(file, "window", [&](TableReader& section) {
    section.AllowOnly(MachineFileKeys("window"));
    section.Number("block", machine.window.block, kSecondsAboveZero);
    section.Number("span", machine.window.span, kSecondsAboveZero);
    section.Number("half_width", machine.window.half_width, kSecondsAboveZero);
    if (machine.window.span < 2 * machine.window.block)
      section.Problem(fmt::format("span = {} s: expected at least two blocks of {} s", machine.window.span,
                                  machine.window.block));
  });
}

void ReadEstimator(TableReader& file, Machine& machine) {
  EstimatorSpec& spec = machine.estimator;
  const Quantity positive{.low = 0, .above_low = true};
  ReadSection(file, "estimator", [&](TableReader& section) {
    section.AllowOnly(MachineFileKeys("estimator"));
    if (const auto choice = section.Choice("equation", {"integral", "published"}))
      spec.equation = *choice == 0 ? EquationForm::kIntegral : EquationForm::kPublished;
    if (const auto choice = section.Choice("form", {"directional", "exponential"}))
      spec.form = *choice == 0 ? EstimatorForm::kDirectional : EstimatorForm::kExponential;
    section.Number("forgetting_factor", spec.forgetting_factor, {.low = 0, .high = 1, .above_low = true});
    section.Number("time_constant", spec.time_constant, kSecondsAboveZero);
    section.Number("initial_covariance", spec.initial_covariance, positive);
    section.Number("initial_parameter", spec.initial_parameter, {});
    section.Flag("initial_from_first_stroke", spec.initial_from_first_stroke);
    section.Number("max_covariance", spec.max_covariance, positive);
    section.Number("dead_zone", spec.dead_zone, {.low = 0});
    section.Number("clip", spec.clip, {.low = 0});
    section.Integer("moving_average", spec.moving_average, 1);
    section.Integer("symmetrical_derivative", spec.symmetrical_derivative, 1);
    section.Number("update_period", spec.update_period, kSecondsAboveZero);
    if (const toml::table* table = section.Table("time_constants")) {
      TableReader constants(*table, "estimator.time_constants", section.problems());
      for (const TableReader::Entry& entry : constants.Entries())
        constants.Number(entry.key, spec.time_constants[entry.key], kSecondsAboveZero);
    }
  });
}

}  // namespace hydroscope
