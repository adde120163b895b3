#include "models/model_history.h"

#include <fmt/format.h>

#include "models/machine_file/keys.h"
#include "models/machine_file/sections.h"
#include "models/machine_file/toml_text.h"

namespace hydroscope {
namespace {

ModelRecord ReadRecord(TableReader& section) {
  ModelRecord record;
  section.AllowOnly(MachineFileKeys("model_history"));
  section.Integer("version", record.version, 1);
  section.Text("name", record.name);
  section.Texts("effects", record.effects);
  section.Text("source", record.source);
  section.Integer("strokes", record.strokes, 0);
  section.Text("unit", record.unit);
  const Quantity error{.si = "", .low = 0};
  section.Number("rms_holdout", record.rms_holdout, error);
  section.Number("noise_floor", record.noise_floor, error);
  const toml::table* table = section.Has("parameters") ? section.Table("parameters") : nullptr;
  if (table == nullptr) return record;
  TableReader parameters(*table, section.path() + ".parameters", section.problems());
  for (const TableReader::Entry& entry : parameters.Entries()) {
    const toml::table* details = parameters.Table(entry.key);
    if (details == nullptr) continue;
    TableReader inner(*details, parameters.path() + "." + entry.key, section.problems());
    inner.AllowOnly(MachineFileKeys("model_history.parameters.<name>"));
    RecordedValue value{entry.key, 0.0, 0.0, ""};
    inner.Number("value", value.value, {.si = ""});
    inner.Number("std", value.std, {.si = "", .low = 0});
    inner.Text("unit", value.unit);
    record.parameters.push_back(std::move(value));
  }
  return record;
}

}  // namespace

std::string FormatModelHistory(const std::vector<ModelRecord>& history) {
  std::string text = history.empty() ? "" : std::string("\n") + kModelHistoryComment + "\n";
  for (const ModelRecord& record : history) {
    std::string effects, parameters;
    for (const std::string& id : record.effects) effects += (effects.empty() ? "" : ", ") + Quoted(id);
    for (const RecordedValue& p : record.parameters)
      parameters += fmt::format("{} = {{ value = {}, std = {}, unit = {} }}\n", Quoted(p.name),
                                FloatText(p.value), FloatText(p.std), Quoted(p.unit));
    text += fmt::format("[[model_history]]\nversion = {}\nname = {}\neffects = [{}]\n", record.version,
                        Quoted(record.name), effects);
    if (record.judged()) {
      text += fmt::format("source = {}\nstrokes = {}\nrms_holdout = {}\nnoise_floor = {}\nunit = {}\n",
                          Quoted(record.source), record.strokes, FloatText(record.rms_holdout),
                          FloatText(record.noise_floor), Quoted(record.unit));
      text += "[model_history.parameters]\n" + parameters;
    }
  }
  return text;
}

void ReadModelHistory(TableReader& file, Machine& machine) {
  if (!file.Has("model_history")) return;
  const toml::node* node = nullptr;
  for (const TableReader::Entry& entry : file.Entries())
    if (entry.key == "model_history") node = entry.node;
  const toml::array* list = node->as_array();
  if (list == nullptr || !list->is_homogeneous<toml::table>()) {
    file.Wrong("model_history", "sections [[model_history]] with two brackets");
    return;
  }
  for (const toml::node& record : *list) {
    TableReader section(*record.as_table(), "model_history", file.problems());
    machine.model_history.push_back(ReadRecord(section));
  }
}

void ReadEffectValues(TableReader& section, Machine& machine) {
  const toml::table* table = section.Has("effect_values") ? section.Table("effect_values") : nullptr;
  if (table == nullptr) return;
  TableReader effects(*table, section.path() + ".effect_values", section.problems());
  for (const TableReader::Entry& effect : effects.Entries()) {
    const toml::table* values = effects.Table(effect.key);
    if (values == nullptr) continue;
    TableReader reader(*values, effects.path() + "." + effect.key, section.problems());
    for (const TableReader::Entry& entry : reader.Entries())
      reader.Number(entry.key, machine.effect_values[effect.key][entry.key], {.si = ""});
  }
}

std::string FormatEffectValues(const std::map<std::string, std::map<std::string, double>>& values) {
  std::string text;
  for (const auto& [effect, numbers] : values) {
    std::string inner;
    for (const auto& [name, value] : numbers)
      inner += fmt::format("{}{} = {}", inner.empty() ? "" : ", ", name, FloatText(value));
    text += fmt::format("{}{} = {{ {} }}", text.empty() ? "" : ", ", effect, inner);
  }
  return "{ " + text + " }";
}

}  // namespace hydroscope
