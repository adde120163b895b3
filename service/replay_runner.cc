#include "service/replay_runner.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "service/explain_report.h"
#include "service/live/raw_log.h"
#include "service/axis_monitor.h"
#include "service/drift_report.h"
#include "service/log_fingerprint.h"
#include "service/log_pass.h"
#include "service/model_edit.h"
#include "service/replay_report.h"
#include "service/stroke_overlays.h"

namespace hydroscope {
namespace {

constexpr std::size_t kStrokesPerTransaction = 32;
constexpr double kAnyPeriod = 0.002;  // s; the layout of the state does not depend on it

std::string ReadText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Magic, version and dimensions that a state of this program begins with.
std::string StateLayout(const Pipeline& pipeline) {
  constexpr std::size_t kHeader = 16;
  const std::vector<std::uint8_t> state = pipeline.SaveState();
  return std::string(state.begin(), state.begin() + std::min(kHeader, state.size()));
}

/// What the report shows of a log in detail.
struct ReportCollector {
  ReportCollector(Pipeline& log, const Machine& machine)
      : pipeline(log), overlays(log), strokes(machine, KeepSamples::kYes) {
    pipeline.set_tap([this, tap = strokes.Tap()](const Stretch& stretch, const SpanEquations& equations) {
      overlays.AddFlows(equations);
      tap(stretch, equations);
    });
  }
  void AddStroke(const StrokeRecord& record) {
    overlays.AddStroke(record);
    strokes.Sink()(StrokeRecord(record));
  }

  Pipeline& pipeline;
  StrokeOverlays overlays;
  StrokeCollector strokes;
};

class ReplayRunner {
 public:
  ReplayRunner(const ReplayOptions& options, Machine machine, Database database)
      : options_(options), machine_(std::move(machine)), database_(std::move(database)) {}

  Result<ReplayOutcome> Run() {
    if (const Status ready = Prepare(); !ready) return tl::unexpected(ready.error());
    ReplayOutcome outcome;
    outcome.machine = machine_;
    for (std::size_t i = 0; i < options_.logs.size(); ++i) {
      const std::string count =
          options_.logs.size() > 1 ? fmt::format("{}/{} ", i + 1, options_.logs.size()) : "";
      outcome.logs.push_back(ReplayLog(options_.logs[i], count));
    }
    if (const Status read = CollectOutcome(database_, machine_id_, *model_, outcome); !read)
      return tl::unexpected(read.error());
    if (const Status judged = Watch(outcome.watch); !judged) return tl::unexpected(judged.error());
    if (!options_.report.empty() && !outcome.runs.empty())
      if (const Status written = Report(outcome); !written) return tl::unexpected(written.error());
    return outcome;
  }

 private:
  Status Prepare();
  Status TakePromoted(std::string& definition);
  Status ReadEarlierSettings();
  bool IsOfEarlierModel(const std::string& settings) const {
    return std::find(earlier_settings_.begin(), earlier_settings_.end(), settings) != earlier_settings_.end();
  }
  Result<int> StoreVersion(const std::string& definition);
  LogReplay ReplayLog(const std::string& log, const std::string& count);
  Status Identify(LogReader& reader, const std::string& what, LogReplay& replay);
  Result<RunFingerprint> Recognise(const std::string& log, LogReplay& replay) const;
  Status Watch(WatchOutcome& watch);
  Status Report(const ReplayOutcome& outcome);
  Status CollectOverlays(const ReplayOutcome& outcome);
  void Take(ReportCollector& collector, const RunInfo& run);

  const ReplayOptions& options_;
  Machine machine_;
  Database database_;
  std::int64_t machine_id_ = 0;
  int model_version_ = 0;
  std::string settings_;
  std::vector<std::string> earlier_settings_;
  std::string promoted_note_;
  std::shared_ptr<const ModelStructure> model_;
  /// Of the log read last, for the report.
  std::vector<StrokeOverlay> overlays_;
  std::optional<LogStrokes> strokes_;
  std::int64_t overlay_run_ = 0;
};

/// Takes over effects, their values and history of the model promoted last. Without one the machine file's
/// stand.
Status ReplayRunner::TakePromoted(std::string& definition) {
  const auto promoted = database_.PromotedModel(machine_id_);
  if (!promoted) return tl::unexpected(promoted.error());
  if (!*promoted) return {};
  const auto model = ParseMachine((*promoted)->definition, machine_.name);
  if (!model)
    return BadInput("{}: the promoted model (version {}) cannot be read: {}", options_.database,
                    (*promoted)->version, model.error().text);
  if (model->added_effects == machine_.added_effects && model->effect_values == machine_.effect_values)
    return {};
  promoted_note_ = fmt::format("model version {} of the database is used, as it was promoted: {}",
                               (*promoted)->version, ModelName(*model));
  machine_.added_effects = model->added_effects;
  machine_.effect_values = model->effect_values;
  machine_.model_version = model->model_version;
  machine_.model_history = model->model_history;
  definition = *model == machine_ ? (*promoted)->definition : EditedMachineText(definition, machine_);
  return {};
}

Status ReplayRunner::Prepare() {
  const auto id = database_.MachineId(machine_.name);
  if (!id) return tl::unexpected(id.error());
  machine_id_ = *id;
  std::string definition = ReadText(options_.machine_file);
  if (const Status taken = TakePromoted(definition); !taken) return taken;
  const auto pipeline = Pipeline::Create(machine_, kAnyPeriod, [](StrokeRecord&&) {});
  if (!pipeline) return tl::unexpected(pipeline.error());
  model_ = (*pipeline)->shared_model();
  settings_ = FingerprintSettings(machine_, StateLayout(**pipeline));
  if (const Status read = ReadEarlierSettings(); !read) return read;
  const auto version = StoreVersion(definition);
  if (!version) return tl::unexpected(version.error());
  model_version_ = *version;
  return {};
}

/// Settings of a replay with this machine file and the model of any stored version.
Status ReplayRunner::ReadEarlierSettings() {
  const auto versions = database_.ModelVersions(machine_id_);
  if (!versions) return tl::unexpected(versions.error());
  for (const ModelVersion& version : *versions) {
    const auto stored = ParseMachine(version.definition, machine_.name);
    if (!stored) continue;
    Machine machine = machine_;
    machine.added_effects = stored->added_effects;
    machine.effect_values = stored->effect_values;
    if (const auto pipeline = Pipeline::Create(machine, kAnyPeriod, [](StrokeRecord&&) {}))
      earlier_settings_.push_back(FingerprintSettings(machine, StateLayout(**pipeline)));
  }
  return {};
}

/// The promoted version itself if it is the same, else the definition as a version of its own.
Result<int> ReplayRunner::StoreVersion(const std::string& definition) {
  const auto promoted = database_.PromotedModel(machine_id_);
  if (!promoted) return tl::unexpected(promoted.error());
  if (*promoted && (*promoted)->definition == definition && (*promoted)->columns == model_->ColumnNames())
    return (*promoted)->version;
  return database_.PutModelVersion(machine_id_, {1, definition, model_->ColumnNames()});
}

/// Fingerprint of the log; an error if its strokes are in the database already under other settings.
Result<RunFingerprint> ReplayRunner::Recognise(const std::string& log, LogReplay& replay) const {
  const auto print = FingerprintRecording(log);
  if (!print) return tl::unexpected(print.error());
  const RunFingerprint own{*print, settings_};
  const auto runs = database_.Runs(machine_id_);
  if (!runs) return tl::unexpected(runs.error());
  for (const RunInfo& run : *runs) {
    RunFingerprint known;
    if (!RunFingerprint::Parse(run.fingerprint, known)) continue;
    if (known.log == own.log && known.settings != own.settings) {
      if (run.complete && IsOfEarlierModel(known.settings)) return known;  // it stays as it is
      return BadInput(
          "{}: the database holds its strokes already (run {}), identified with other settings in the "
          "machine file or by "
          "another version of the program; a stroke is kept once. Replay all logs into a new database",
          log, run.id);
    }
    const auto grown = Continues(log, known.log);
    if (grown && *grown)
      return BadInput(
          "{}: the beginning of this log was replayed before (run {}, {}), and it has grown since; its "
          "strokes "
          "would be counted twice. Replay logs that are finished, or all of them into a new database",
          log, run.id, run.source);
    if (!run.complete && !run.abandoned && !(known.log == own.log) && run.strokes > 0)
      replay.notes.push_back(fmt::format("the replay of {} had stopped after {} strokes; it stays as it is",
                                         run.source, run.strokes));
  }
  return own;
}

LogReplay ReplayRunner::ReplayLog(const std::string& log, const std::string& count) {
  LogReplay replay;
  replay.log = log;
  if (!promoted_note_.empty()) replay.notes.push_back(promoted_note_);
  const auto fail = [&](const Error& error) {
    replay.status = ReplayStatus::kFailed;
    replay.problem = error.text;
    return replay;
  };
  auto reader = OpenRecording(log, machine_);
  if (!reader) return fail(reader.error());
  const auto fingerprint = Recognise(log, replay);
  if (!fingerprint) return fail(fingerprint.error());
  const auto run = database_.BeginRun(machine_id_, model_version_, log, fingerprint->Text());
  if (!run) return fail(run.error());
  replay.run = *run;
  replay.stored_before = run->strokes;
  if (run->complete) {
    replay.status = ReplayStatus::kAlready;
    replay.summary = ParseRunSummary(run->summary_json);
    return replay;
  }
  if (const Status done = Identify(**reader, count + std::filesystem::path(log).filename().string(), replay);
      !done)
    return fail(done.error());
  replay.status = run->strokes > 0 ? ReplayStatus::kContinued : ReplayStatus::kReplayed;
  return replay;
}

Status ReplayRunner::Identify(LogReader& reader, const std::string& what, LogReplay& replay) {
  std::vector<StrokeRecord> batch;
  std::optional<ReportCollector> collector;
  auto created = Pipeline::Create(machine_, reader.SamplePeriod(), [&](StrokeRecord&& record) {
    if (collector) collector->AddStroke(record);
    batch.push_back(std::move(record));
  });
  if (!created) return tl::unexpected(created.error());
  Pipeline& pipeline = **created;
  if (!options_.report.empty()) collector.emplace(pipeline, machine_);
  const auto state = database_.PipelineStateBefore(replay.run.id);
  if (!state) return tl::unexpected(state.error());
  if (*state)
    if (const Status restored = pipeline.RestoreState(**state); !restored)
      replay.notes.push_back("the estimator starts anew: " + restored.error().text);

  std::int64_t strokes = 0;
  const auto store = [&](std::size_t at_least) -> Status {
    if (batch.size() < at_least) return {};
    strokes += static_cast<std::int64_t>(batch.size());
    const Status stored = database_.StoreStrokes(replay.run.id, batch);
    batch.clear();
    return stored;
  };
  LogPassHooks hooks;
  hooks.after_block = [&] { return store(kStrokesPerTransaction); };
  auto pass = PassLog(reader, machine_, &pipeline, what, hooks);
  if (!pass) return tl::unexpected(pass.error());
  if (const Status stored = store(1); !stored) return stored;
  replay.summary = std::move(pass->summary);
  if (const Status finished =
          database_.FinishRun(replay.run.id, FormatRunSummary(replay.summary), pipeline.SaveState());
      !finished)
    return finished;
  replay.run.strokes = strokes;
  replay.run.complete = true;
  if (collector) Take(*collector, replay.run);
  return {};
}

void ReplayRunner::Take(ReportCollector& collector, const RunInfo& run) {
  overlays_ = collector.overlays.Choose(run.first_sequence);
  strokes_ = collector.strokes.Finish(collector.pipeline);
  overlay_run_ = run.id;
}

/// If the last log had been replayed before, it is read again for its overlays; nothing is stored.
Status ReplayRunner::CollectOverlays(const ReplayOutcome& outcome) {
  const LogReplay* last = nullptr;
  for (const LogReplay& replay : outcome.logs)
    if (replay.status != ReplayStatus::kFailed && replay.run.strokes > 0) last = &replay;
  if (last == nullptr || last->run.id == overlay_run_) return {};
  auto reader = OpenRecording(last->log, machine_);
  if (!reader) return tl::unexpected(reader.error());
  std::optional<ReportCollector> collector;
  auto pipeline = Pipeline::Create(machine_, (*reader)->SamplePeriod(),
                                   [&](StrokeRecord&& record) { collector->AddStroke(record); });
  if (!pipeline) return tl::unexpected(pipeline.error());
  collector.emplace(**pipeline, machine_);
  const auto state = database_.PipelineStateBefore(last->run.id);
  if (!state) return tl::unexpected(state.error());
  if (*state)
    static_cast<void>((*pipeline)->RestoreState(**state));  // as the run itself: anew if it does not fit
  const auto pass = PassLog(**reader, machine_, pipeline->get(), "overlay for the report");
  if (!pass) return tl::unexpected(pass.error());
  Take(*collector, last->run);
  return {};
}

/// Judges the strokes that are new in the database, as the live service does stroke by stroke.
Status ReplayRunner::Watch(WatchOutcome& watch) {
  const auto rules = RulesFor(options_.machine_file);
  if (!rules) return tl::unexpected(rules.error());
  auto journal = AlarmJournal::Open(AlarmJournal::PathFor(options_.database));
  if (!journal) return tl::unexpected(journal.error());
  AxisMonitor axis(machine_, model_, *rules, database_, options_.database, machine_id_, *journal);
  if (!axis.watchable()) {
    watch.problem = axis.watchable().error().text;
    return {};
  }
  const double wall = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  if (const Status judged = axis.CatchUp(wall); !judged) return judged;
  watch.reference_version = axis.monitor() != nullptr ? axis.monitor()->reference().version() : 0;
  watch.commissioning_strokes = axis.commissioning_strokes();
  watch.commissioning_needed = rules->commissioning;
  watch.health = axis.Health();
  for (const AlarmState& alarm : axis.alarms())
    if (!AtRest(alarm)) watch.alarms.push_back(alarm);
  if (options_.report.empty()) return {};
  auto section = DriftSection(axis, rules->commissioning);
  if (!section) return tl::unexpected(section.error());
  watch.section_html = std::move(*section);
  watch.verdict_html = DriftVerdictBox(axis);
  return {};
}

Status ReplayRunner::Report(const ReplayOutcome& outcome) {
  if (const Status collected = CollectOverlays(outcome); !collected) return collected;
  auto input = MakeReportInput(database_, machine_id_, outcome, std::move(overlays_));
  if (!input) return tl::unexpected(input.error());
  input->drift_verdict = outcome.watch.verdict_html;
  input->drift = outcome.watch.section_html;
  if (strokes_)
    if (const auto explained = ExplainStrokes(std::move(*strokes_)); explained) {
      input->explanation_verdict = ExplainVerdictBox(*explained);
      input->explanation_leads = explained->explanation.verdict != Verdict::kAdequate;
      input->explanation = ExplainSections(*explained, false);
    }
  return WriteReport(options_.report, *input);
}

}  // namespace

const char* StatusName(ReplayStatus status) {
  switch (status) {
    case ReplayStatus::kReplayed:
      return "replayed";
    case ReplayStatus::kContinued:
      return "continued";
    case ReplayStatus::kAlready:
      return "already_replayed";
    case ReplayStatus::kFailed:
      return "failed";
  }
  return "";
}

bool ReplayOutcome::Complete() const {
  return std::all_of(logs.begin(), logs.end(), [](const LogReplay& r) {
    return r.status != ReplayStatus::kFailed && r.run.strokes > 0 && r.summary.rejected_rows == 0 &&
           r.summary.stopped.empty();
  });
}

bool ReplayOutcome::Failed() const {
  return std::all_of(logs.begin(), logs.end(),
                     [](const LogReplay& r) { return r.status == ReplayStatus::kFailed; });
}

Result<ReplayOutcome> RunReplay(const ReplayOptions& options) {
  auto machine = LoadMachine(options.machine_file);
  if (!machine) return tl::unexpected(machine.error());
  auto database = Database::Open(options.database);
  if (!database) return tl::unexpected(database.error());
  return ReplayRunner(options, std::move(*machine), std::move(*database)).Run();
}

}  // namespace hydroscope
