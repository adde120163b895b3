#include "workbench/model/model_change.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "core/counted_words.h"
#include "core/shell_word.h"
#include "core/short_number.h"
#include "core/told_error.h"
#include "host/text_file.h"
#include "host/work_line.h"
#include "models/machine_kind.h"
#include "models/output_unit.h"
#include "pipeline/log_trust.h"
#include "workbench/held_out_log.h"
#include "workbench/model/model_edit.h"
#include "workbench/model/model_history_output.h"
#include "workbench/states/states_log.h"

namespace hydroscope {
namespace {

struct Evidence {
  std::optional<ModelEvidence> before, next;
  std::optional<std::pair<HeldOutError, HeldOutError>> held_out;  ///< before, next
  std::vector<Told> warnings;  ///< how the log was read for the next, and what of it was taken otherwise
};

/// Both models, fitted to `strokes`, on a log that neither was fitted to.
Result<std::pair<HeldOutError, HeldOutError>> OnHeldOut(const std::string& log, LogStrokes strokes,
                                                        const Machine& before, const Machine& next) {
  const auto held_out = TRY(ReadStrokes(log, before, KeepSamples::kYes));
  std::vector<HeldOutError> errors;
  for (const Machine* machine : {&before, &next}) {
    strokes.machine = *machine;
    auto error = TRY(ErrorHeldOut(strokes, held_out, log));
    errors.push_back(std::move(error));
  }
  return std::make_pair(errors[0], errors[1]);
}

/// The same for a machine with states.
Result<Evidence> OnEpisodes(const ModelChange& change, const Machine& before, const Machine& next) {
  if (!change.hold_out.empty())
    return UsageError(
        "--hold-out of 'model' is not there for machines with [states] yet; use 'compare --hold-out'");
  auto log = TRY(ReadEpisodes(change.logs, before));
  const std::string source = fmt::format("{}", fmt::join(change.logs, ", "));
  Evidence out;
  WorkLine line("model");
  for (const Machine* machine : {&before, &next}) {
    EpisodeLog episodes = log;
    episodes.machine = *machine;
    const auto fit = TRY(FitEpisodes(std::move(episodes), line.Listener()));
    (machine == &before ? out.before : out.next) = ModelEvidence{RecordOf(fit, source), {}};
    out.warnings = fit.log.warnings;
  }
  return out;
}

/// Both models on the same strokes; the logs are read once.
Result<Evidence> OnLogs(const ModelChange& change, const Machine& before, const Machine& next) {
  if (KindOf(before).has_states) return OnEpisodes(change, before, next);
  const auto logs = TRY(ChooseLogs(change.logs, change.hold_out));
  auto strokes = TRY(ReadStrokes(logs.fitted, before, KeepSamples::kYes));
  const std::string source = fmt::format("{}", fmt::join(logs.fitted, ", "));
  if (const LogTrust trust = JudgeStrokes(strokes); !trust.rate.fast_enough)
    return BadInput(Tell("{}: {}; without the log the model is changed unjudged",
                         "{}: {}; ohne das Log wird das Modell unbeurteilt geändert", source,
                         trust.rate.sentence));
  Evidence out;
  out.before = TRY(JudgeModel(before, strokes, source));
  if (!logs.held_out.empty()) {
    out.held_out = TRY(OnHeldOut(logs.held_out, strokes, before, next));
  }
  out.next = TRY(JudgeModel(next, std::move(strokes), source));
  return out;
}

Result<Evidence> OnStrokes(const Database& database, const ModelChange& change,
                           const std::vector<HistoryPart>& parts, const Machine& before,
                           const Machine& next) {
  const auto history = TRY(LoadHistory(database, change.history.db, parts, before));
  auto judged_before = TRY(JudgeModel(before, history));
  auto judged_next = TRY(JudgeModel(next, history));
  return Evidence{std::move(judged_before), std::move(judged_next), {}, {}};
}

/// The one machine meant: the one named, that of the machine file, or the only one.
Result<HistoryPart> OneMachine(Database& database, const HistoryOptions& o, const std::string& name) {
  std::vector<std::string> names = o.machines;
  if (names.empty() && !name.empty()) names = {name};
  auto parts = TRY(ChosenMachines(database, o.db, names));
  if (parts.size() != 1) {
    std::vector<std::string> known;
    for (const HistoryPart& part : parts) known.push_back(part.machine);
    return UsageError("{} holds {} machines ({}); choose one with --machine-name", o.db, parts.size(),
                      fmt::join(known, ", "));
  }
  TRY(Narrow(database, o.from, o.to, parts.front()));
  return parts.front();
}

Result<Evidence> Judge(const ModelChange& change, const Machine& before, const Machine& next) {
  if (!change.logs.empty()) return OnLogs(change, before, next);
  if (change.history.db.empty()) return Evidence{};
  auto database = TRY(Database::OpenReadOnly(change.history.db));
  const auto part = TRY(OneMachine(database, change.history, before.name));
  return OnStrokes(database, change, {part}, before, next);
}

std::string EvidenceHint(const Evidence& evidence, const std::string& path) {
  return evidence.next
             ? ""
             : fmt::format(
                   "Not judged on data yet. See the error with it: hydroscope compare LOG --machine {}\n",
                   ShellWord(path));
}

/// The errors on the log held out, and what speaks against adding there.
void TellHeldOut(const Machine& next, const Evidence& evidence, const std::string& effect, bool adds,
                 ModelChanged& changed) {
  if (!evidence.held_out) return;
  const auto& [before, after] = *evidence.held_out;
  const DisplayUnit unit = UnitOfRecord(next, evidence.next->record.unit);
  changed.held_out = {{"log", after.log},
                      {"strokes", after.strokes},
                      {"before", before.rms * unit.factor},
                      {"after", after.rms * unit.factor},
                      {"unit", unit.name}};
  changed.text += fmt::format("Error on {}, held out: {} -> {} {}, {}\n", after.log,
                              ShortNumber(before.rms * unit.factor), ShortNumber(after.rms * unit.factor),
                              unit.name, Counted(after.strokes, "stroke"));
  if (adds && !(after.rms < before.rms))
    changed.warnings.push_back(Tell("on {}, which was held out, {} does not lower the error",
                                    "auf {}, das ausgelassen war, senkt {} den Fehler nicht", after.log,
                                    effect));
}

/// What a change did to the error, with what speaks against it.
void TellError(const Machine& before, const Machine& next, const Evidence& evidence,
               const std::string& effect, ModelChanged& changed) {
  const bool adds = next.added_effects.size() > before.added_effects.size();
  changed.error = LastStepJson(next);
  changed.warnings = evidence.warnings;
  if (adds && evidence.before && evidence.next)
    std::ranges::move(AddingWarnings(next, effect, *evidence.before, *evidence.next),
                      std::back_inserter(changed.warnings));
  TellHeldOut(next, evidence, effect, adds, changed);
  for (const std::string& warning : InEnglish(changed.warnings))
    changed.text += fmt::format("WARNING: {}.\n", warning);
}

Result<ModelChanged> ChangeFile(const ModelChange& change, MakeNext make_next) {
  const auto machine = TRY(LoadMachine(change.machine));
  auto next = TRY(make_next(machine, change.effect, NextVersion(change.machine, machine)));
  const auto evidence = TRY(Judge(change, machine, next));
  AddRecords(machine, evidence.before, evidence.next, change.name, next);
  const bool adds = next.added_effects.size() > machine.added_effects.size();
  if (const auto kept = FindKept(change.machine, machine, next); kept && !adds && change.out.empty()) {
    const auto beside = TRY(RestoreVersion(change.machine, machine.model_version, *kept));
    const auto restored = TRY(LoadMachine(change.machine));
    ModelChanged changed{
        restored,
        fmt::format("{}: again model version {}, byte for byte\nThe version with {} is kept as {}\n{}",
                    change.machine, restored.model_version, change.effect, beside, LastStepText(next)),
        change.machine, true};
    TellError(machine, next, evidence, change.effect, changed);
    return changed;
  }
  const std::string path = change.out.empty() ? change.machine : change.out;
  const auto kept = TRY(WriteVersion(change.machine, path, machine.model_version, next));
  std::string text =
      fmt::format("{}: model version {}, {}\n", path, next.model_version, next.model_history.back().name);
  if (!kept.empty()) text += fmt::format("The version before is kept as {}\n", kept);
  ModelChanged changed{next, text + LastStepText(next) + EvidenceHint(evidence, path), path, false};
  TellError(machine, next, evidence, change.effect, changed);
  return changed;
}

Result<ModelChanged> ChangeDatabase(const ModelChange& change, MakeNext make_next) {
  auto database = TRY(Database::Open(change.history.db));
  const auto part = TRY(OneMachine(database, change.history, ""));
  const auto versions = TRY(database.ModelVersions(part.id));
  const auto machine = TRY(NewestStoredModel(database, part));
  auto next = TRY(make_next(machine, change.effect, NextVersion("", machine)));
  auto evidence = TRY(change.logs.empty() ? OnStrokes(database, change, {part}, machine, next)
                                          : OnLogs(change, machine, next));
  AddRecords(machine, evidence.before, evidence.next, change.name, next);
  const auto stored =
      TRY(StoreModel(database, part.id, EditedMachineText(versions.back().definition, next), next));
  ModelChanged changed{
      next,
      fmt::format("{}: model version {} of {}, {}\n{}\nMake it the model of replay and monitor: hydroscope "
                  "model promote --db {}\n",
                  change.history.db, stored, part.machine, next.model_history.back().name, LastStepText(next),
                  ShellWord(change.history.db)),
      change.history.db, false};
  TellError(machine, next, evidence, change.effect, changed);
  return changed;
}

}  // namespace

Result<Machine> NewestStoredModel(const Database& database, const HistoryPart& part) {
  const auto versions = TRY(database.ModelVersions(part.id));
  if (versions.empty())
    return BadInput(Tell("machine {} has no model in the database yet",
                         "Maschine {} hat in der Datenbank noch kein Modell", part.machine));
  return ParseMachine(versions.back().definition, part.machine);
}

Result<ModelChanged> ChangeModel(const ModelChange& change, MakeNext make_next) {
  if (change.machine.empty() && change.history.db.empty())
    return UsageError("give the machine file with --machine, or a database with --db");
  if (!change.hold_out.empty() && change.logs.empty())
    return UsageError("--hold-out needs other logs that the model is fitted to");
  return change.machine.empty() ? ChangeDatabase(change, make_next) : ChangeFile(change, make_next);
}

Result<ModelChanged> UndoModel(const std::string& machine_file) {
  const auto machine = TRY(LoadMachine(machine_file));
  std::vector<KeptVersion> kept = KeptVersions(machine_file);
  std::erase_if(kept, [&](const KeptVersion& v) { return v.version >= machine.model_version; });
  if (kept.empty())
    return BadInput(Tell("{}: no version before {} is kept beside it",
                         "{}: keine Version vor {} ist daneben aufbewahrt", machine_file,
                         machine.model_version));
  const auto beside = TRY(RestoreVersion(machine_file, machine.model_version, kept.back()));
  const auto restored = TRY(LoadMachine(machine_file));
  return ModelChanged{
      restored,
      fmt::format("{}: again model version {}, byte for byte\nThe version taken back is kept as {}\n",
                  machine_file, restored.model_version, beside),
      machine_file, true};
}

Result<ModelChanged> PromoteModel(const HistoryOptions& history, const std::string& machine_file,
                                  Promotion promotion) {
  auto database = TRY(Database::Open(history.db));
  if (!machine_file.empty()) {
    const auto machine = TRY(LoadMachine(machine_file));
    const auto id = TRY(database.MachineId(machine.name));
    promotion.machine = machine.name;
    promotion.id = id;
    promotion.text = TRY(ReadTextFile(machine_file));
  } else {
    const auto part = TRY(OneMachine(database, history, ""));
    promotion.machine = part.machine;
    promotion.id = part.id;
    const auto versions = TRY(database.ModelVersions(part.id));
    if (promotion.version == 0 && !versions.empty()) promotion.version = versions.back().version;
  }
  const auto promoted = TRY(Promote(database, history.db, promotion));
  return ModelChanged{
      promoted.machine,
      fmt::format("{}: version {} of {} ({}) is the model of replay and monitor now\n", history.db,
                  promoted.version, promotion.machine, ModelName(promoted.machine)),
      history.db, false};
}

}  // namespace hydroscope
