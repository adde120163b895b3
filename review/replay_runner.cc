#include "review/replay_runner.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "host/real_clock.h"
#include "monitor/press_monitor.h"
#include "pipeline/axis_log.h"
#include "pipeline/log_fingerprint.h"
#include "pipeline/log_pass.h"
#include "pipeline/log_trust.h"
#include "pipeline/physical_sizes.h"
#include "pipeline/raw_log.h"
#include "replay/resampled_reader.h"
#include "report/drift_report.h"
#include "report/explain_report.h"
#include "report/stroke_overlays.h"
#include "review/replay_report.h"
#include "workbench/model/model_edit.h"

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
      : pipeline(log), overlays(log), strokes(machine, KeepSamples::kYes), tap(strokes.Tap()) {
    pipeline.set_tap([this](const Stretch& s, const SpanEquations& equations) { AddStretch(s, equations); });
  }
  void AddStretch(const Stretch& stretch, const SpanEquations& equations) {
    overlays.AddFlows(equations);
    tap(stretch, equations);
  }
  void AddStroke(const StrokeRecord& record) {
    overlays.AddStroke(record);
    strokes.Sink()(StrokeRecord(record));
  }

  Pipeline& pipeline;
  StrokeOverlays overlays;
  StrokeCollector strokes;
  Pipeline::EquationTap tap;
};

/// Takes effects, their values and history of the model promoted last for machine `id` over into `machine`,
/// and returns that version; nullopt without one, or if the machine file's are the same.
Result<std::optional<ModelVersion>> TakePromoted(const Database& database, const std::string& path,
                                                 std::int64_t id, Machine& machine) {
  auto promoted = database.PromotedModel(id);
  if (!promoted || !*promoted) return promoted;
  const auto model = ParseMachine((*promoted)->definition, machine.name);
  if (!model)
    return BadInput("{}: the promoted model (version {}) cannot be read: {}", path, (*promoted)->version,
                    model.error().text);
  if (model->added_effects == machine.added_effects && model->effect_values == machine.effect_values)
    return std::nullopt;
  machine.added_effects = model->added_effects;
  machine.effect_values = model->effect_values;
  machine.model_version = model->model_version;
  machine.model_history = model->model_history;
  return promoted;
}

/// Stores the strokes of one axis, or of a machine that is its only one, and writes its report.
class AxisReplay {
 public:
  /// `share.logs` are replayed; `report`: the file to write, "" = none.
  AxisReplay(const ReplayOptions& options, LogsOfAxis share, std::string report, Machine machine,
             Database database)
      : options_(options),
        share_(std::move(share)),
        report_(std::move(report)),
        file_machine_(std::move(machine)),
        database_(std::move(database)) {}

  Status Store(ReplayOutcome& outcome) {
    if (const Status ready = Prepare(); !ready) return ready;
    outcome.machine = machine_;
    for (std::size_t i = 0; i < share_.logs.size(); ++i) {
      const std::string count =
          share_.logs.size() > 1 ? fmt::format("{}/{} ", i + 1, share_.logs.size()) : "";
      outcome.logs.push_back(ReplayLog(share_.logs[i], count));
    }
    return CollectOutcome(database_, machine_id_, *model_, outcome);
  }
  Status Report(ReplayOutcome& outcome);

 private:
  Status Prepare();
  Result<std::string> TakePromotedModel();
  Status ReadEarlierSettings();
  bool IsOfEarlierModel(const std::string& settings) const {
    return std::find(earlier_settings_.begin(), earlier_settings_.end(), settings) != earlier_settings_.end();
  }
  Result<int> StoreVersion(const std::string& definition);
  Result<std::unique_ptr<LogReader>> Open(const std::string& log, std::string& note) const;
  LogReplay ReplayLog(const std::string& log, const std::string& count);
  Status Identify(LogReader& reader, const std::string& what, LogReplay& replay);
  Result<RunFingerprint> Recognise(const std::string& log, LogReplay& replay) const;
  Status CollectOverlays(const ReplayOutcome& outcome);
  void Take(ReportCollector& collector, const RunInfo& run);

  const ReplayOptions& options_;
  LogsOfAxis share_;
  std::string report_;
  Machine file_machine_;  ///< as the file has it, with the promoted model
  Machine machine_;       ///< of this axis
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

/// Takes over the promoted model; the text that describes the machine then.
Result<std::string> AxisReplay::TakePromotedModel() {
  const std::string definition = ReadText(options_.machine_file);
  const auto promoted = TakePromoted(database_, options_.database, machine_id_, file_machine_);
  if (!promoted) return tl::unexpected(promoted.error());
  if (!*promoted) return definition;
  promoted_note_ = fmt::format("model version {} of the database is used, as it was promoted: {}",
                               (*promoted)->version, ModelName(file_machine_));
  const auto model = ParseMachine((*promoted)->definition, file_machine_.name);
  return model && *model == file_machine_ ? (*promoted)->definition
                                          : EditedMachineText(definition, file_machine_);
}

Status AxisReplay::Prepare() {
  const auto id = database_.MachineId(AxisMachineName(file_machine_, share_.axis));
  if (!id) return tl::unexpected(id.error());
  machine_id_ = *id;
  const auto definition = TakePromotedModel();
  if (!definition) return tl::unexpected(definition.error());
  machine_ = MachineOfAxis(file_machine_, share_.axis);
  const auto pipeline = Pipeline::Create(machine_, kAnyPeriod, [](StrokeRecord&&) {});
  if (!pipeline) return tl::unexpected(pipeline.error());
  model_ = (*pipeline)->shared_model();
  settings_ = FingerprintSettings(machine_, StateLayout(**pipeline));
  if (const Status read = ReadEarlierSettings(); !read) return read;
  const auto version = StoreVersion(*definition);
  if (!version) return tl::unexpected(version.error());
  model_version_ = *version;
  return {};
}

/// Settings of a replay with this machine file and the model of any stored version.
Status AxisReplay::ReadEarlierSettings() {
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
Result<int> AxisReplay::StoreVersion(const std::string& definition) {
  const auto promoted = database_.PromotedModel(machine_id_);
  if (!promoted) return tl::unexpected(promoted.error());
  if (*promoted && (*promoted)->definition == definition && (*promoted)->columns == model_->ColumnNames())
    return (*promoted)->version;
  return database_.PutModelVersion(machine_id_,
                                   {1, definition, model_->ColumnNames(), 0, model_->ConditionNames()});
}

/// Fingerprint of the log; an error if its strokes are in the database already under other settings.
Result<RunFingerprint> AxisReplay::Recognise(const std::string& log, LogReplay& replay) const {
  std::error_code ignored;
  if (const auto raw = ParseRawName(log);
      raw && std::filesystem::equivalent(raw->database, options_.database, ignored))
    return BadInput(
        "{}: this database holds the strokes of its raw window already; replay it into another one", log);
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
          "machine file or by another version of the program; a stroke is kept "
          "once. Replay all logs into a new database",
          log, run.id);
    }
    const auto grown = Continues(log, known.log);
    if (grown && *grown)
      return BadInput(
          "{}: the beginning of this log was replayed before (run {}, {}), and it has grown since; its "
          "strokes would be counted twice. Replay logs that are finished, or all of them into a new database",
          log, run.id, run.source);
    if (!run.complete && !run.abandoned && !(known.log == own.log) && run.strokes > 0)
      replay.notes.push_back(fmt::format("the replay of {} had stopped after {} strokes; it stays as it is",
                                         run.source, run.strokes));
  }
  return own;
}

/// The log, at the sample period of the machine's runs so far where that is nearly its own.
Result<std::unique_ptr<LogReader>> AxisReplay::Open(const std::string& log, std::string& note) const {
  const auto runs = database_.Runs(machine_id_);
  if (!runs) return tl::unexpected(runs.error());
  double period = 0;
  for (const RunInfo& run : *runs)
    if (period <= 0) period = ParseRunSummary(run.summary_json).sample_period;
  return OpenRecording(log, machine_, period, note);
}

LogReplay AxisReplay::ReplayLog(const std::string& log, const std::string& count) {
  LogReplay replay;
  replay.log = log;
  if (!promoted_note_.empty()) replay.notes.push_back(promoted_note_);
  const auto fail = [&](const Error& error) {
    replay.status = ReplayStatus::kFailed;
    replay.problem = error.text;
    return replay;
  };
  if (const Status plausible = JudgeSizes(log, machine_); !plausible) return fail(plausible.error());
  std::string note;
  auto reader = Open(log, note);
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
  if (!note.empty()) replay.notes.push_back(note);
  if (const Status done = Identify(**reader, count + std::filesystem::path(log).filename().string(), replay);
      !done)
    return fail(done.error());
  replay.status = run->strokes > 0 ? ReplayStatus::kContinued : ReplayStatus::kReplayed;
  return replay;
}

Status AxisReplay::Identify(LogReader& reader, const std::string& what, LogReplay& replay) {
  std::vector<StrokeRecord> batch;
  std::optional<ReportCollector> collector;
  FirstStrokes first(machine_);
  auto created = Pipeline::Create(machine_, reader.SamplePeriod(), [&](StrokeRecord&& record) {
    if (collector) collector->AddStroke(record);
    first.AddStroke(record);
    batch.push_back(std::move(record));
  });
  if (!created) return tl::unexpected(created.error());
  Pipeline& pipeline = **created;
  if (!report_.empty()) collector.emplace(pipeline, machine_);
  pipeline.set_tap([&](const Stretch& stretch, const SpanEquations& equations) {
    first.AddStretch(stretch, equations);
    if (collector) collector->AddStretch(stretch, equations);
  });
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
  const LogTrust trust = first.Judge(pipeline);
  replay.summary.warnings = trust.Warnings();
  if (!trust.rate.fast_enough) replay.summary.too_slow = trust.rate.sentence;
  replay.notes.insert(replay.notes.end(), replay.summary.warnings.begin(), replay.summary.warnings.end());
  if (const Status finished =
          database_.FinishRun(replay.run.id, FormatRunSummary(replay.summary), pipeline.SaveState());
      !finished)
    return finished;
  replay.run.strokes = strokes;
  replay.run.complete = true;
  if (collector) Take(*collector, replay.run);
  return {};
}

void AxisReplay::Take(ReportCollector& collector, const RunInfo& run) {
  overlays_ = collector.overlays.Choose(run.first_sequence);
  strokes_ = collector.strokes.Finish(collector.pipeline);
  overlay_run_ = run.id;
}

/// If the last log had been replayed before, it is read again for its overlays; nothing is stored.
Status AxisReplay::CollectOverlays(const ReplayOutcome& outcome) {
  const LogReplay* last = nullptr;
  for (const LogReplay& replay : outcome.logs)
    if (replay.status != ReplayStatus::kFailed && replay.run.strokes > 0) last = &replay;
  if (last == nullptr || last->run.id == overlay_run_) return {};
  std::string note;
  auto reader = Open(last->log, note);
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

Status AxisReplay::Report(ReplayOutcome& outcome) {
  if (report_.empty() || outcome.runs.empty()) return {};
  if (const Status collected = CollectOverlays(outcome); !collected) return collected;
  auto input = MakeReportInput(database_, machine_id_, outcome, std::move(overlays_));
  if (!input) return tl::unexpected(input.error());
  input->drift_verdict = outcome.watch.verdict_html;
  input->drift = outcome.watch.section_html;
  if (strokes_)
    if (const auto explained = ExplainStrokes(std::move(*strokes_)); explained) {
      input->explanation_verdict = ExplainVerdictBox(*explained);
      if (explained->explanation.no_verdict.empty())
        input->misses = explained->explanation.verdict != Verdict::kAdequate;
      input->explanation_leads = explained->explanation.verdict != Verdict::kAdequate;
      input->explanation = ExplainSections(*explained, false);
    }
  outcome.report = report_;
  return WriteReport(report_, *input);
}

/// "press.html" -> "press_cushion_1.html".
std::string ReportOfAxis(const std::string& report, const std::string& axis) {
  if (report.empty()) return "";
  const std::filesystem::path path(report);
  return path.parent_path() / (path.stem().string() + "_" + axis + path.extension().string());
}

/// All axes of the press that the database holds, with the models in force.
Result<std::vector<Machine>> StoredAxes(const ReplayOptions& options, const Machine& machine,
                                        Database& database) {
  const auto names = database.MachineNames();
  if (!names) return tl::unexpected(names.error());
  std::vector<Machine> axes;
  for (int axis = 0; axis < AxisCount(machine); ++axis) {
    const std::string name = AxisMachineName(machine, axis);
    if (std::find(names->begin(), names->end(), name) == names->end()) continue;
    const auto id = database.MachineId(name);
    if (!id) return tl::unexpected(id.error());
    Machine own = machine;
    if (const auto taken = TakePromoted(database, options.database, *id, own); !taken)
      return tl::unexpected(taken.error());
    axes.push_back(MachineOfAxis(own, axis));
  }
  return axes;
}

/// What watching for drift says about one machine.
Status TakeWatch(const PressMonitor& press, const AxisMonitor& axis, bool for_report, WatchOutcome& watch) {
  watch.reference_version = axis.monitor() != nullptr ? axis.monitor()->reference().version() : 0;
  watch.commissioning_strokes = axis.commissioning_strokes();
  watch.commissioning_needed = press.rules().commissioning;
  watch.problem = axis.why_not_learned();
  watch.health = axis.Health();
  watch.health_text = axis.JudgedHealth().text;
  watch.notice = press.notice();
  for (const AlarmState& alarm : axis.alarms())
    if (!AtRest(alarm)) watch.alarms.push_back(alarm);
  if (!for_report) return {};
  auto section = DriftSection(axis, press.rules().commissioning);
  if (!section) return tl::unexpected(section.error());
  watch.section_html = std::move(*section);
  watch.verdict_html = AlarmsBox(press.alarms(), axis.alarms());
  return {};
}

/// Judges the strokes that are new in the database, as the live service does stroke by stroke.
Status WatchForDrift(const ReplayOptions& options, const Machine& machine, PressReplay& replay) {
  auto database = Database::Open(options.database);
  if (!database) return tl::unexpected(database.error());
  auto axes = StoredAxes(options, machine, *database);
  if (!axes) return tl::unexpected(axes.error());
  const auto created =
      PressMonitor::Create(options.machine_file, machine.name, std::move(*axes), options.database);
  if (!created) return tl::unexpected(created.error());
  PressMonitor& press = **created;
  if (const Status watchable = press.watchable(); !watchable) {
    for (ReplayOutcome& outcome : replay.machines) outcome.watch.problem = watchable.error().text;
    return {};
  }
  if (const Status judged = press.CatchUp(WallSeconds()); !judged) return judged;
  for (const AlarmState& alarm : press.alarms())
    if (!AtRest(alarm)) replay.alarms.push_back(alarm);
  for (ReplayOutcome& outcome : replay.machines)
    if (const AxisMonitor* axis = press.Find(outcome.machine.name))
      if (const Status taken = TakeWatch(press, *axis, !options.report.empty(), outcome.watch); !taken)
        return taken;
  return {};
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

bool PressReplay::Complete() const {
  return std::all_of(machines.begin(), machines.end(), [](const ReplayOutcome& m) { return m.Complete(); });
}

bool PressReplay::Failed() const {
  return std::all_of(machines.begin(), machines.end(), [](const ReplayOutcome& m) { return m.Failed(); });
}

Result<PressReplay> RunReplay(const ReplayOptions& options) {
  const auto machine = LoadMachine(options.machine_file);
  if (!machine) return tl::unexpected(machine.error());
  const auto shares = ShareOutLogs(*machine, options.logs, options.axis);
  if (!shares) return tl::unexpected(shares.error());
  PressReplay replay;
  if (HasNamedAxes(*machine)) replay.press = machine->name;
  std::vector<std::unique_ptr<AxisReplay>> axes;
  for (const LogsOfAxis& share : *shares) {
    auto database = Database::Open(options.database);
    if (!database) return tl::unexpected(database.error());
    const std::string report =
        shares->size() > 1
            ? ReportOfAxis(options.report, machine->live->axes[static_cast<std::size_t>(share.axis)])
            : options.report;
    axes.push_back(std::make_unique<AxisReplay>(options, share, report, *machine, std::move(*database)));
    if (const Status stored = axes.back()->Store(replay.machines.emplace_back()); !stored)
      return tl::unexpected(stored.error());
  }
  if (const Status judged = WatchForDrift(options, *machine, replay); !judged)
    return tl::unexpected(judged.error());
  for (std::size_t a = 0; a < axes.size(); ++a)
    if (const Status written = axes[a]->Report(replay.machines[a]); !written)
      return tl::unexpected(written.error());
  return replay;
}

}  // namespace hydroscope
