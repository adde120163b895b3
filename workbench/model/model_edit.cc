#include "workbench/model/model_edit.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <vector>

#include "core/contains.h"
#include "core/told_error.h"
#include "host/text_file.h"
#include "host/text_sink.h"
#include "models/find_effect.h"
#include "models/machine_kind.h"
#include "models/model_structure.h"
#include "models/state_model.h"

namespace hydroscope {
namespace {

bool IsAdded(const Machine& machine, const std::string& id) { return Contains(machine.added_effects, id); }

std::string Trimmed(const std::string& line) {
  const auto first = line.find_first_not_of(" \t\r");
  return first == std::string::npos ? "" : line.substr(first);
}

/// Whether the line sets `key`.
bool Sets(const std::string& line, const std::string& key) {
  const std::string text = Trimmed(line);
  if (text.rfind(key, 0) != 0) return false;
  const auto after = text.find_first_not_of(" \t", key.size());
  return after != std::string::npos && text[after] == '=';
}

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// Keeps the present text of `path` beside it under its version; returns the name.
Result<std::string> KeepBeside(const std::string& path, int version) {
  const auto text = ReadTextFile(path);
  if (!text) return text;
  const std::filesystem::path target(path);
  const std::string kept = (target.parent_path() / fmt::format("{}.v{}{}", target.stem().string(), version,
                                                               target.extension().string()))
                               .string();
  TRY(WriteTextFile(kept, *text));
  return kept;
}

/// Everything but what a version of the model may change.
Machine WithoutModel(Machine machine) {
  machine.added_effects.clear();
  machine.effect_values.clear();
  machine.model_history.clear();
  machine.model_version = 1;
  return machine;
}

/// Lines of the sections [[model_history]] are left out, with the comment above them.
std::string WithoutHistory(const std::string& text) {
  std::string out;
  bool in_history = false;
  for (const std::string& line : Lines(text)) {
    const std::string trimmed = Trimmed(line);
    if (trimmed.rfind('[', 0) == 0)
      in_history = trimmed.rfind("[[model_history]]", 0) == 0 || trimmed.rfind("[model_history.", 0) == 0;
    if (!in_history && trimmed != kModelHistoryComment) out += line + "\n";
  }
  while (out.size() > 1 && out.ends_with("\n\n")) out.pop_back();
  return out;
}

}  // namespace

Result<Machine> WithEffect(const Machine& machine, const std::string& id, int version) {
  if (IsAdded(machine, id))
    return BadInput(Tell("effect '{}' is already part of the model of {}",
                         "der Effekt '{}' gehört schon zum Modell von {}", id, machine.name));
  Machine next = machine;
  next.added_effects.push_back(id);
  if (KindOf(machine).has_states) {
    TRY(BuildStateModel(next, next.added_effects));
    next.model_version = version;
    return next;
  }
  const auto model = TRY(BuildModel(machine));
  ModelStructure library = *model;
  AddSampleEffects(library, {id});
  TRY(FindEffect(library, id));
  next.model_version = version;
  return next;
}

Result<Machine> WithoutEffect(const Machine& machine, const std::string& id, int version) {
  if (!IsAdded(machine, id))
    return BadInput(Tell(
        "effect '{}' is not part of the model of {}; its effects: {}",
        "der Effekt '{}' gehört nicht zum Modell von {}; dessen Effekte: {}", id, machine.name,
        machine.added_effects.empty() ? Told("none", "keine")
                                      : Told(fmt::format("{}", fmt::join(machine.added_effects, ", ")))));
  Machine next = machine;
  std::erase(next.added_effects, id);
  next.effect_values.erase(id);
  next.model_version = version;
  return next;
}

void AddRecords(const Machine& before, const std::optional<ModelEvidence>& evidence_before,
                const std::optional<ModelEvidence>& evidence_next, const std::string& name, Machine& next) {
  const auto record = [](const Machine& machine, const std::optional<ModelEvidence>& evidence) {
    if (evidence) return evidence->record;
    ModelRecord plain;
    plain.version = machine.model_version;
    plain.name = ModelName(machine);
    plain.effects = machine.added_effects;
    return plain;
  };
  std::vector<ModelRecord>& history = next.model_history;
  const auto known =
      std::ranges::find_if(history, [&](const ModelRecord& r) { return r.version == before.model_version; });
  if (known == history.end()) {
    history.push_back(record(before, evidence_before));
  } else if (evidence_before) {
    const std::string kept = known->name;
    *known = evidence_before->record;
    known->name = kept;
  }
  history.push_back(record(next, evidence_next));
  if (!name.empty()) history.back().name = name;
  if (evidence_next) next.effect_values = evidence_next->effect_values;
}

std::string EditedMachineText(const std::string& text, const Machine& next) {
  std::string effects;
  for (const std::string& id : next.added_effects)
    effects += fmt::format("{}\"{}\"", effects.empty() ? "" : ", ", id);
  const std::string added =
      fmt::format("model_version = {}\n", next.model_version) +
      (effects.empty() ? "" : fmt::format("effects = [{}]\n", effects)) +
      (next.effect_values.empty()
           ? ""
           : fmt::format("effect_values = {}\n", FormatEffectValues(next.effect_values)));
  std::string out;
  bool in_machine = false, written = false;
  for (const std::string& line : Lines(WithoutHistory(text))) {
    if (Trimmed(line).rfind('[', 0) == 0) in_machine = Trimmed(line).rfind("[machine]", 0) == 0;
    if (in_machine && (Sets(line, "model_version") || Sets(line, "effects") || Sets(line, "effect_values")))
      continue;
    out += line + "\n";
    if (in_machine && !written) {
      out += added;
      written = true;
    }
  }
  out += FormatModelHistory(next.model_history);
  const auto read_back = ParseMachine(out, next.name);
  return read_back && *read_back == next ? out : FormatMachine(next);
}

std::vector<KeptVersion> KeptVersions(const std::string& path) {
  const std::filesystem::path target(path);
  const std::string begin = target.stem().string() + ".v", end = target.extension().string();
  const std::filesystem::path folder = target.parent_path().empty() ? "." : target.parent_path();
  std::vector<KeptVersion> kept;
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failure)) {
    const std::string name = entry.path().filename().string();
    if (name.size() <= begin.size() + end.size() || !name.starts_with(begin) || !name.ends_with(end))
      continue;
    const std::string number = name.substr(begin.size(), name.size() - begin.size() - end.size());
    if (number.size() > 8 || number.find_first_not_of("0123456789") != std::string::npos) continue;
    kept.push_back({std::stoi(number), (target.parent_path() / name).string()});
  }
  std::ranges::sort(kept, [](const auto& a, const auto& b) { return a.version < b.version; });
  return kept;
}

int NextVersion(const std::string& path, const Machine& machine) {
  int most = machine.model_version;
  for (const ModelRecord& record : machine.model_history) most = std::max(most, record.version);
  for (const KeptVersion& kept : KeptVersions(path)) most = std::max(most, kept.version);
  return most + 1;
}

std::optional<KeptVersion> FindKept(const std::string& path, const Machine& machine, const Machine& wanted) {
  std::vector<KeptVersion> kept = KeptVersions(path);
  std::ranges::reverse(kept);
  for (const KeptVersion& candidate : kept) {
    const auto text = ReadTextFile(candidate.path);
    auto loaded = text ? ParseMachine(*text, path) : Result<Machine>(BadInput("cannot be read"));
    if (loaded && loaded->added_effects == wanted.added_effects &&
        WithoutModel(*loaded) == WithoutModel(machine))
      return candidate;
  }
  return std::nullopt;
}

Result<std::string> WriteVersion(const std::string& from, const std::string& path, int version_before,
                                 const Machine& next) {
  const auto text = TRY(ReadTextFile(from));
  std::string kept;
  if (std::filesystem::exists(path)) {
    kept = TRY(KeepBeside(path, version_before));
  }
  TRY(WriteTextFile(path, EditedMachineText(text, next)));
  return kept;
}

Result<std::string> RestoreVersion(const std::string& path, int version_before, const KeptVersion& kept) {
  const auto text = TRY(ReadTextFile(kept.path));
  const auto name = KeepBeside(path, version_before);
  if (!name) return name;
  TRY(WriteTextFile(path, text));
  return *name;
}

}  // namespace hydroscope
