#include "workbench/model/model_history_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "core/constants.h"
#include "core/contains.h"
#include "core/interval_text.h"
#include "core/non_negative.h"
#include "core/short_number.h"
#include "core/shown_width.h"
#include "estimation/gram_fit.h"
#include "models/machine_kind.h"
#include "models/output_unit.h"
#include "models/parameter_unit.h"
#include "workbench/model/model_record.h"

namespace hydroscope {
namespace {

double ShownError(const Machine& machine, const ModelRecord& record, double si) {
  return si * UnitOfRecord(machine, record.unit).factor;
}
std::string_view ErrorUnit(const Machine& machine, const ModelRecord& record) {
  return UnitOfRecord(machine, record.unit).name;
}

const RecordedValue* Find(const ModelRecord& record, const std::string& name) {
  for (const RecordedValue& value : record.parameters)
    if (value.name == name) return &value;
  return nullptr;
}

std::string Staircase(const Machine& machine) {
  const std::vector<ModelRecord>& history = machine.model_history;
  constexpr int kBar = 14;
  double most = 0;
  std::size_t width = 0;
  for (const ModelRecord& record : history) {
    most = std::max({most, record.rms_holdout, record.noise_floor});
    width = std::max(width, ShownWidth(record.name));
  }
  std::string text;
  for (const ModelRecord& record : history) {
    if (!record.judged()) {
      text += fmt::format("  {:>3}  {:<{}}  not judged\n", record.version, record.name, width);
      continue;
    }
    const auto mark = [&](double rms) { return static_cast<int>(std::lround(kBar * rms / most)); };
    std::string bar(static_cast<std::size_t>(mark(record.rms_holdout)), '#');
    bar.resize(kBar + 1, ' ');
    bar[mark(record.noise_floor)] = '|';
    text += fmt::format("  {:>3}  {:<{}} {:>8}  {}  {} strokes of {}\n", record.version, record.name, width,
                        ShortNumber(ShownError(machine, record, record.rms_holdout)), bar, record.strokes,
                        record.source);
  }
  return text;
}

/// Rows of parameters, a column per judged version: of as many of the newest as a line holds, two at least.
std::string Parameters(const MachineKind& kind, const std::vector<const ModelRecord*>& judged) {
  std::vector<std::vector<std::string>> columns(
      1);  // the names, then of each version its number and its values
  for (const ModelRecord* record : judged)
    for (const RecordedValue& value : record->parameters)
      if (!Contains(columns[0], value.name)) columns[0].push_back(value.name);
  columns[0].insert(columns[0].begin(), "");
  for (const ModelRecord* record : judged) {
    std::vector<std::string>& column = columns.emplace_back();
    column.push_back(fmt::format("version {}", record->version));
    for (std::size_t row = 1; row < columns[0].size(); ++row) {
      const RecordedValue* value = Find(*record, columns[0][row]);
      column.push_back(value == nullptr
                           ? "-"
                           : ParameterWithInterval(kind, value->name, value->value, value->std, value->unit));
    }
  }
  std::vector<std::size_t> widths;
  for (const std::vector<std::string>& column : columns) {
    widths.push_back(0);
    for (const std::string& cell : column) widths.back() = std::max(widths.back(), ShownWidth(cell));
  }
  constexpr std::size_t kIndent = 2, kGap = 2, kFewest = 2;
  const auto line = [&] {
    return std::accumulate(widths.begin(), widths.end(), kIndent + kGap * (widths.size() - 1));
  };
  while (columns.size() > 1 + kFewest && line() > kLineWidth) {
    columns.erase(columns.begin() + 1);
    widths.erase(widths.begin() + 1);
  }
  std::string text;
  for (std::size_t row = 0; row < columns[0].size(); ++row) {
    std::string written = fmt::format("{:{}}{:<{}}", "", kIndent, columns[0][row], widths[0]);
    for (std::size_t k = 1; k < columns.size(); ++k) {
      const std::size_t space = kGap + widths[k] - ShownWidth(columns[k][row]);
      written += std::string(space, ' ') + columns[k][row];
    }
    text += written + "\n";
  }
  return text;
}

std::vector<const ModelRecord*> Judged(const std::vector<ModelRecord>& history) {
  std::vector<const ModelRecord*> judged;
  for (const ModelRecord& record : history)
    if (record.judged()) judged.push_back(&record);
  return judged;
}

/// The last two versions of a history, if both were judged.
std::optional<std::pair<const ModelRecord*, const ModelRecord*>> LastStep(const Machine& machine) {
  const auto& history = machine.model_history;
  if (history.size() < 2 || !history.back().judged() || !history[history.size() - 2].judged())
    return std::nullopt;
  return std::make_pair(&history[history.size() - 2], &history.back());
}

}  // namespace

std::string ModelHistoryText(const Machine& machine) {
  std::string text =
      fmt::format("{}: model {}, version {}\n", machine.name, machine.model, machine.model_version);
  if (machine.model_history.empty())
    return text + "No history: 'hydroscope model add EFFECT LOG' writes it.\n";
  std::vector<const ModelRecord*> judged = Judged(machine.model_history);
  text += fmt::format("\nError on strokes left out{}; | is what sensor noise alone would cause\n",
                      judged.empty() ? "" : fmt::format(", {}", ErrorUnit(machine, *judged.front())));
  text += Staircase(machine);
  if (!judged.empty()) text += "\nParameters, ± 95 % interval\n" + Parameters(KindOf(machine), judged);
  return text;
}

std::string LastStepText(const Machine& machine) {
  const auto step = LastStep(machine);
  if (!step) return "";
  const ModelRecord &before = *step->first, &after = *step->second;
  return fmt::format("Error on strokes left out: {} -> {} {}; sensor noise alone would cause {}\n\n{}",
                     ShortNumber(ShownError(machine, before, before.rms_holdout)),
                     ShortNumber(ShownError(machine, after, after.rms_holdout)), ErrorUnit(machine, after),
                     ShortNumber(ShownError(machine, after, after.noise_floor)),
                     Parameters(KindOf(machine), {&before, &after}));
}

namespace {

/// Whether the error energy on strokes left out falls by less than its scatter between them explains (95 %).
bool WithinChance(const Eigen::VectorXd& before, const Eigen::VectorXd& next) {
  if (before.size() != next.size()) return false;
  double n = 0, sum = 0, squares = 0;
  for (Eigen::Index s = 0; s < before.size(); ++s) {
    const double gain = before[s] - next[s];
    if (!std::isfinite(gain)) continue;
    n += 1;
    sum += gain;
    squares += gain * gain;
  }
  if (n < 2) return false;
  const double variance = NonNegative(squares - sum * sum / n) / (n - 1);
  return sum <= kNormal95 * StudentFactor(n - 1) * std::sqrt(n * variance);
}

}  // namespace

std::vector<Told> AddingWarnings(const Machine& machine, const std::string& effect,
                                 const ModelEvidence& judged_before, const ModelEvidence& judged_next) {
  const auto step = LastStep(machine);
  if (!step) return {};
  const ModelRecord &before = *step->first, &after = *step->second;
  std::vector<Told> warnings;
  if (!(after.rms_holdout < before.rms_holdout))
    warnings.push_back(Tell(
        "{} makes the model no better: on strokes left out the error is {:.3g} {} with it and {:.3g} {} "
        "without. Take it out again with 'hydroscope model undo' or 'model remove {}'",
        "{0} macht das Modell nicht besser: der Fehler auf ausgelassenen Hüben ist {1:.3g} {2} damit und {3:.3g} {4} ohne",
        effect, ShownError(machine, after, after.rms_holdout), ErrorUnit(machine, after),
        ShownError(machine, before, before.rms_holdout), ErrorUnit(machine, before), effect));
  else if (WithinChance(judged_before.excess, judged_next.excess))
    warnings.push_back(Tell(
        "{} lowers the error on strokes left out by no more than chance does: {:.3g} {} with it and {:.3g} {} without. Take it "
        "out again with 'hydroscope model undo' or 'model remove {}'",
        "{0} senkt den Fehler auf ausgelassenen Hüben nicht mehr, als der Zufall es tut: {1:.3g} {2} damit und {3:.3g} {4} ohne",
        effect, ShownError(machine, after, after.rms_holdout), ErrorUnit(machine, after),
        ShownError(machine, before, before.rms_holdout), ErrorUnit(machine, before), effect));
  const auto is_its_own = [&](const RecordedValue& value) { return value.name.starts_with(effect + "."); };
  const bool one_size = std::ranges::count_if(after.parameters, is_its_own) == 1;
  for (const RecordedValue& value : after.parameters)
    if (Contains(judged_next.outside_physics, value.name))
      warnings.push_back(Tell(
          "{} comes out as {}, which physics forbids: the model misses another effect, or a signal is wrong",
          "{} kommt als {} heraus, was die Physik verbietet: dem Modell fehlt ein anderer Effekt, oder ein "
          "Signal ist falsch",
          is_its_own(value) && one_size ? Tell("the size of {}", "die Größe von {}", effect)
                                        : Told(value.name),
          TellNumber(
              ParameterWithInterval(KindOf(machine), value.name, value.value, value.std, value.unit))));
  for (const RecordedValue& value : after.parameters)
    if (is_its_own(value) && std::abs(value.value) <= kNormal95 * value.std)
      warnings.push_back(
          Tell("{} cannot be told from zero: {}", "{} ist nicht von null zu unterscheiden: {}",
               one_size ? Tell("the size of {}", "die Größe von {}", effect) : Told(value.name),
               TellNumber(ShownWithInterval(value.value, value.std, value.unit))));
  return warnings;
}

nlohmann::json LastStepJson(const Machine& machine) {
  const auto step = LastStep(machine);
  if (!step) return nullptr;
  const ModelRecord &before = *step->first, &after = *step->second;
  return {{"before", ShownError(machine, before, before.rms_holdout)},
          {"after", ShownError(machine, after, after.rms_holdout)},
          {"noise_floor", ShownError(machine, after, after.noise_floor)},
          {"unit", ErrorUnit(machine, after)}};
}

nlohmann::json ModelHistoryJson(const Machine& machine) {
  nlohmann::json versions = nlohmann::json::array();
  for (const ModelRecord& record : machine.model_history) {
    nlohmann::json entry = {{"version", record.version},
                            {"name", record.name},
                            {"effects", record.effects},
                            {"source", nullptr},
                            {"strokes", record.strokes},
                            {"rms_holdout", nullptr},
                            {"noise_floor", nullptr},
                            {"unit", ErrorUnit(machine, record)},
                            {"parameters", nlohmann::json::object()}};
    if (record.judged()) {
      entry["source"] = record.source;
      entry["rms_holdout"] = ShownError(machine, record, record.rms_holdout);
      entry["noise_floor"] = ShownError(machine, record, record.noise_floor);
    }
    for (const RecordedValue& v : record.parameters)
      entry["parameters"][v.name] = {
          {"value", v.value},
          {"std", v.std},
          {"unit", v.unit},
          {"interval95", {v.value - kNormal95 * v.std, v.value + kNormal95 * v.std}}};
    versions.push_back(std::move(entry));
  }
  return {{"machine", machine.name},
          {"model_version", machine.model_version},
          {"effects", machine.added_effects},
          {"versions", versions}};
}

std::string StoredVersionsText(const std::vector<ModelVersion>& versions) {
  int latest = 0;
  for (const ModelVersion& v : versions) latest = std::max(latest, v.promoted);
  std::string text = "\nIn the database\n";
  for (const ModelVersion& v : versions) {
    const auto machine = ParseMachine(v.definition, "model");
    text += fmt::format("  {:>3}  {}{}\n", v.version,
                        machine ? fmt::format("{} (model version {} of its file)", ModelName(*machine),
                                              machine->model_version)
                                : std::string("written by another program version"),
                        v.promoted == 0        ? ""
                        : v.promoted == latest ? "   <- the model of replay and monitor"
                                               : "   promoted before");
  }
  return text;
}

nlohmann::json StoredVersionsJson(const std::vector<ModelVersion>& versions) {
  int latest = 0;
  for (const ModelVersion& v : versions) latest = std::max(latest, v.promoted);
  nlohmann::json out = nlohmann::json::array();
  for (const ModelVersion& v : versions) {
    const auto machine = ParseMachine(v.definition, "model");
    out.push_back({{"version", v.version},
                   {"effects", machine ? nlohmann::json(machine->added_effects) : nlohmann::json()},
                   {"model_version", machine ? nlohmann::json(machine->model_version) : nlohmann::json()},
                   {"promoted", v.promoted > 0},
                   {"in_force", latest > 0 && v.promoted == latest}});
  }
  return out;
}

}  // namespace hydroscope
