#include "service/model_change.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "service/log_trust.h"
#include "service/model_edit.h"
#include "service/model_history_output.h"

namespace hydroscope {
namespace {

struct Evidence {
  std::optional<ModelEvidence> before, next;
};

/// Both models on the same strokes; the log is read once.
Result<Evidence> OnLog(const std::string& log, const Machine& before, const Machine& next) {
  auto strokes = ReadStrokes(log, before, KeepSamples::kYes);
  if (!strokes) return tl::unexpected(strokes.error());
  if (const LogTrust trust = JudgeStrokes(*strokes); !trust.rate.fast_enough)
    return BadInput("{}: {}; without the log the model is changed unjudged", log, trust.rate.sentence);
  auto judged_before = JudgeModel(before, *strokes, log);
  if (!judged_before) return tl::unexpected(judged_before.error());
  auto judged_next = JudgeModel(next, std::move(*strokes), log);
  if (!judged_next) return tl::unexpected(judged_next.error());
  return Evidence{std::move(*judged_before), std::move(*judged_next)};
}

Result<Evidence> OnStrokes(const Database& database, const ModelChange& change,
                           const std::vector<HistoryPart>& parts, const Machine& before,
                           const Machine& next) {
  const auto history = LoadHistory(database, change.history.db, parts, before);
  if (!history) return tl::unexpected(history.error());
  auto judged_before = JudgeModel(before, *history);
  if (!judged_before) return tl::unexpected(judged_before.error());
  auto judged_next = JudgeModel(next, *history);
  if (!judged_next) return tl::unexpected(judged_next.error());
  return Evidence{std::move(*judged_before), std::move(*judged_next)};
}

/// The one machine meant: the one named, that of the machine file, or the only one.
Result<HistoryPart> OneMachine(Database& database, const HistoryOptions& o, const std::string& name) {
  std::vector<std::string> names = o.machines;
  if (names.empty() && !name.empty()) names = {name};
  auto parts = ChosenMachines(database, o.db, names);
  if (!parts) return tl::unexpected(parts.error());
  if (parts->size() != 1) {
    std::vector<std::string> known;
    for (const HistoryPart& part : *parts) known.push_back(part.machine);
    return UsageError("{} holds {} machines ({}); choose one with --machine-name", o.db, parts->size(),
                      fmt::join(known, ", "));
  }
  if (const Status narrowed = Narrow(database, o.from, o.to, parts->front()); !narrowed)
    return tl::unexpected(narrowed.error());
  return parts->front();
}

Result<Evidence> Judge(const ModelChange& change, const Machine& before, const Machine& next) {
  if (!change.log.empty()) return OnLog(change.log, before, next);
  if (change.history.db.empty()) return Evidence{};
  auto database = Database::OpenReadOnly(change.history.db);
  if (!database) return tl::unexpected(database.error());
  const auto part = OneMachine(*database, change.history, before.name);
  if (!part) return tl::unexpected(part.error());
  return OnStrokes(*database, change, {*part}, before, next);
}

std::string EvidenceHint(const Evidence& evidence, const std::string& path) {
  return evidence.next
             ? ""
             : fmt::format(
                   "Not judged on data yet. See the error with it: hydroscope compare LOG --machine {}\n",
                   path);
}

Result<ModelChanged> ChangeFile(const ModelChange& change, MakeNext make_next) {
  const auto machine = LoadMachine(change.machine);
  if (!machine) return tl::unexpected(machine.error());
  auto next = make_next(*machine, change.effect, NextVersion(change.machine, *machine));
  if (!next) return tl::unexpected(next.error());
  const auto evidence = Judge(change, *machine, *next);
  if (!evidence) return tl::unexpected(evidence.error());
  AddRecords(*machine, evidence->before, evidence->next, change.name, *next);
  const bool adds = next->added_effects.size() > machine->added_effects.size();
  if (const auto kept = FindKept(change.machine, *machine, *next); kept && !adds && change.out.empty()) {
    const auto beside = RestoreVersion(change.machine, machine->model_version, *kept);
    if (!beside) return tl::unexpected(beside.error());
    const auto restored = LoadMachine(change.machine);
    if (!restored) return tl::unexpected(restored.error());
    return ModelChanged{
        *restored,
        fmt::format("{}: again model version {}, byte for byte\nThe version with {} is kept as {}\n{}",
                    change.machine, restored->model_version, change.effect, *beside, LastStepText(*next)),
        change.machine, true};
  }
  const std::string path = change.out.empty() ? change.machine : change.out;
  const auto kept = WriteVersion(change.machine, path, machine->model_version, *next);
  if (!kept) return tl::unexpected(kept.error());
  std::string text =
      fmt::format("{}: model version {}, {}\n", path, next->model_version, next->model_history.back().name);
  if (!kept->empty()) text += fmt::format("The version before is kept as {}\n", *kept);
  return ModelChanged{*next, text + LastStepText(*next) + EvidenceHint(*evidence, path), path, false};
}

/// Stores a definition; returns its version in the database.
Result<int> StoreModel(Database& database, const HistoryPart& part, const std::string& definition,
                       const Machine& machine) {
  const auto model = BuildModel(machine);
  if (!model) return tl::unexpected(model.error());
  return database.PutModelVersion(part.id, {0, definition, (*model)->ColumnNames()});
}

Result<ModelChanged> ChangeDatabase(const ModelChange& change, MakeNext make_next) {
  auto database = Database::Open(change.history.db);
  if (!database) return tl::unexpected(database.error());
  const auto part = OneMachine(*database, change.history, "");
  if (!part) return tl::unexpected(part.error());
  const auto versions = database->ModelVersions(part->id);
  if (!versions) return tl::unexpected(versions.error());
  const auto machine = NewestStoredModel(*database, *part);
  if (!machine) return tl::unexpected(machine.error());
  auto next = make_next(*machine, change.effect, NextVersion("", *machine));
  if (!next) return tl::unexpected(next.error());
  auto evidence = change.log.empty() ? OnStrokes(*database, change, {*part}, *machine, *next)
                                     : OnLog(change.log, *machine, *next);
  if (!evidence) return tl::unexpected(evidence.error());
  AddRecords(*machine, evidence->before, evidence->next, change.name, *next);
  const auto stored =
      StoreModel(*database, *part, EditedMachineText(versions->back().definition, *next), *next);
  if (!stored) return tl::unexpected(stored.error());
  return ModelChanged{
      *next,
      fmt::format("{}: model version {} of {}, {}\n{}\nMake it the model of replay and monitor: hydroscope "
                  "model promote --db {}\n",
                  change.history.db, *stored, part->machine, next->model_history.back().name,
                  LastStepText(*next), change.history.db),
      change.history.db, false};
}

Result<std::string> TextOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  if (!file) return BadInput("cannot read {}", path);
  return text.str();
}

}  // namespace

Result<Machine> NewestStoredModel(const Database& database, const HistoryPart& part) {
  const auto versions = database.ModelVersions(part.id);
  if (!versions) return tl::unexpected(versions.error());
  if (versions->empty()) return BadInput("machine {} has no model in the database yet", part.machine);
  return ParseMachine(versions->back().definition, part.machine);
}

Result<ModelChanged> ChangeModel(const ModelChange& change, MakeNext make_next) {
  if (change.machine.empty() && change.history.db.empty())
    return UsageError("give the machine file with --machine, or a database with --db");
  return change.machine.empty() ? ChangeDatabase(change, make_next) : ChangeFile(change, make_next);
}

Result<ModelChanged> UndoModel(const std::string& machine_file) {
  const auto machine = LoadMachine(machine_file);
  if (!machine) return tl::unexpected(machine.error());
  std::vector<KeptVersion> kept = KeptVersions(machine_file);
  std::erase_if(kept, [&](const KeptVersion& v) { return v.version >= machine->model_version; });
  if (kept.empty())
    return BadInput("{}: no version before {} is kept beside it", machine_file, machine->model_version);
  const auto beside = RestoreVersion(machine_file, machine->model_version, kept.back());
  if (!beside) return tl::unexpected(beside.error());
  const auto restored = LoadMachine(machine_file);
  if (!restored) return tl::unexpected(restored.error());
  return ModelChanged{
      *restored,
      fmt::format("{}: again model version {}, byte for byte\nThe version taken back is kept as {}\n",
                  machine_file, restored->model_version, *beside),
      machine_file, true};
}

Result<ModelChanged> PromoteModel(const HistoryOptions& history, const std::string& machine_file,
                                  int version) {
  auto database = Database::Open(history.db);
  if (!database) return tl::unexpected(database.error());
  Result<Machine> machine = UsageError("no machine");
  HistoryPart part;
  if (!machine_file.empty()) {
    machine = LoadMachine(machine_file);
    if (!machine) return tl::unexpected(machine.error());
    const auto id = database->MachineId(machine->name);
    if (!id) return tl::unexpected(id.error());
    part = {machine->name, *id, 0, 0};
    const auto text = TextOf(machine_file);
    if (!text) return tl::unexpected(text.error());
    const auto stored = StoreModel(*database, part, *text, *machine);
    if (!stored) return tl::unexpected(stored.error());
    version = *stored;
  } else {
    const auto found = OneMachine(*database, history, "");
    if (!found) return tl::unexpected(found.error());
    part = *found;
    const auto versions = database->ModelVersions(part.id);
    if (!versions) return tl::unexpected(versions.error());
    if (version == 0 && !versions->empty()) version = versions->back().version;
    const auto chosen = database->GetModelVersion(part.id, version);
    if (!chosen) return tl::unexpected(chosen.error());
    machine = ParseMachine(chosen->definition, part.machine);
    if (!machine) return tl::unexpected(machine.error());
  }
  if (const Status promoted = database->PromoteModel(part.id, version); !promoted)
    return tl::unexpected(promoted.error());
  return ModelChanged{*machine,
                      fmt::format("{}: version {} of {} ({}) is the model of replay and monitor now\n",
                                  history.db, version, part.machine, ModelName(*machine)),
                      history.db, false};
}

}  // namespace hydroscope
