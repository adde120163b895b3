#include "review/axis_replay.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "core/contains.h"
#include "host/text_file.h"
#include "models/counted_words.h"
#include "models/machine_kind.h"
#include "models/output_unit.h"
#include "monitor/promoted_model.h"
#include "pipeline/doubtful_estimates.h"
#include "pipeline/episode_pipeline.h"
#include "pipeline/episodes.h"
#include "pipeline/log_faults/broken_strokes.h"
#include "pipeline/log_faults/physical_sizes.h"
#include "pipeline/log_fingerprint.h"
#include "pipeline/log_pass.h"
#include "pipeline/log_trust.h"
#include "pipeline/raw_log.h"
#include "pipeline/stroke_overlays.h"
#include "report/explain_report.h"
#include "review/replay_report.h"
#include "review/stored_explanation.h"
#include "workbench/explain/explain_log.h"
#include "workbench/frequency_response/loop_log.h"
#include "workbench/history/stored_change.h"
#include "workbench/model/model_record.h"

namespace hydroscope {
namespace {

constexpr std::size_t kStrokesPerTransaction = 32;
/// Rows that are read before for where sensors end, some 0.02 s: logs are seldom longer, and in those that are they end soon.
constexpr std::int64_t kRowsLookedAt = 1 << 17;
constexpr double kAnyPeriod = 0.002;  // s; the layout of the state does not depend on it

/// Magic, version and dimensions that a state of this program begins with.
std::string StateLayout(const Pipeline& pipeline) {
  constexpr std::size_t kHeader = 16;
  const std::vector<std::uint8_t> state = pipeline.SaveState();
  return std::string(state.begin(), state.begin() + std::min(kHeader, state.size()));
}

/// What keeps a part of the input of a machine in closed loop from plant or log; nothing of other machines.
std::vector<Told> InputDoubts(const std::string& log, const Machine& machine) {
  if (ClosedLoopOf(machine) == nullptr) return {};
  const auto measured = MeasureLoopLog(log, machine);
  return measured ? InputDoubtsOf(*ClosedLoopOf(machine), measured->response) : std::vector<Told>();
}

}  // namespace

/// What the report shows of a log in detail.
struct AxisReplay::ReportCollector {
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

Status AxisReplay::Store(ReplayOutcome& outcome) {
  TRY(Prepare());
  outcome.machine = machine_;
  for (std::size_t i = 0; i < share_.logs.size(); ++i) {
    const std::string count = share_.logs.size() > 1 ? fmt::format("{}/{} ", i + 1, share_.logs.size()) : "";
    outcome.logs.push_back(ReplayLog(share_.logs[i], count));
  }
  return CollectOutcome(database_, machine_id_, *model_, outcome);
}
bool AxisReplay::IsOfEarlierModel(const std::string& settings) const {
  return Contains(earlier_settings_, settings);
}

/// Takes over the promoted model; the text that describes the machine then.
Result<std::string> AxisReplay::TakePromotedModel() {
  const std::string definition = ReadTextFile(options_.machine_file).value_or("");
  auto promoted = TRY(PromotedFor(database_, options_.database, machine_id_, file_machine_, definition));
  if (!promoted) return definition;
  file_machine_ = std::move(promoted->machine);
  promoted_note_ = fmt::format("model version {} of the database is used, as it was promoted: {}",
                               promoted->version, ModelName(file_machine_));
  return promoted->text;
}

Status AxisReplay::Prepare() {
  machine_id_ = TRY(database_.MachineId(AxisMachineName(file_machine_, share_.axis)));
  const auto definition = TRY(TakePromotedModel());
  machine_ = MachineOfAxis(file_machine_, share_.axis);
  const auto pipeline = TRY(Pipeline::Create(machine_, kAnyPeriod, [](StrokeRecord&&) {}));
  model_ = pipeline->shared_model();
  settings_ = FingerprintSettings(machine_, StateLayout(*pipeline));
  TRY(ReadEarlierSettings());
  model_version_ = TRY(VersionFor(database_, machine_id_,
                                  {1, definition, model_->ColumnNames(), 0, model_->ConditionNames()}));
  return {};
}

/// Settings of a replay with this machine file and the model of any stored version.
Status AxisReplay::ReadEarlierSettings() {
  const auto versions = TRY(database_.ModelVersions(machine_id_));
  for (const ModelVersion& version : versions) {
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

/// Fingerprint of the log; an error if its strokes are in the database already under other settings.
Result<RunFingerprint> AxisReplay::Recognise(const std::string& log, LogReplay& replay) const {
  std::error_code ignored;
  if (const auto raw = ParseRawName(log);
      raw && std::filesystem::equivalent(raw->database, options_.database, ignored))
    return BadInput(
        "{}: this database holds the strokes of its raw window already; replay it into another one", log);
  const auto print = TRY(FingerprintRecording(log));
  const RunFingerprint own{print, settings_};
  const auto runs = TRY(database_.Runs(machine_id_));
  for (const RunInfo& run : runs) {
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
  const auto runs = TRY(database_.Runs(machine_id_));
  double period = 0;
  for (const RunInfo& run : runs)
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
  if (KindOf(machine_).has_states)
    if (const Status signs = JudgeSigns(log, machine_); !signs) return fail(signs.error());
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

/// What a look at the beginning of a log leaves out of it: readings where sensors turn out to end or to have frozen, from the first
/// one on. Sensors that end later are seen while it is replayed; of a machine with states the whole log is looked at.
LogPassHooks AxisReplay::KnownOf(const std::string& log) const {
  if (KindOf(machine_).has_states) return KnownOfEpisodes(log, machine_);
  LogPassHooks known;
  std::string note;
  auto reader = Open(log, note);
  if (!reader) return known;
  LogPassHooks look;
  look.most_rows = kRowsLookedAt;
  if (auto pass = PassLog(**reader, machine_, nullptr, "looking at the signals", look)) {
    known.known_cut_offs = std::move(pass->cut_offs);
    known.known_frozen = std::move(pass->frozen);
  }
  return known;
}

Status AxisReplay::Identify(LogReader& reader, const std::string& what, LogReplay& replay) {
  std::vector<StrokeRecord> batch;
  std::int64_t silent = 0;  // episodes that tell of no parameter
  Told reversed;
  std::optional<ReportCollector> collector;
  FirstStrokes first(machine_);
  auto created = TRY(Pipeline::Create(machine_, reader.SamplePeriod(), [&](StrokeRecord&& record) {
    if (collector) collector->AddStroke(record);
    first.AddStroke(record);
    silent += record.estimates.empty() ? 1 : 0;
    if (!record.estimates.empty()) reversed = ReversedIn(machine_, record.estimates);
    batch.push_back(std::move(record));
  }));
  Pipeline& pipeline = *created;
  if (!report_.empty() && ShowsStretches()) collector.emplace(pipeline, machine_);
  pipeline.set_tap([&](const Stretch& stretch, const SpanEquations& equations) {
    first.AddStretch(stretch, equations);
    if (collector) collector->AddStretch(stretch, equations);
  });
  const auto state = TRY(database_.PipelineStateBefore(replay.run.id));
  if (state)
    if (const Status restored = pipeline.RestoreState(*state); !restored)
      replay.notes.push_back("the estimator starts anew: " + restored.error().text);

  std::int64_t strokes = 0;
  const auto store = [&](std::size_t at_least) -> Status {
    if (batch.size() < at_least) return {};
    strokes += static_cast<std::int64_t>(batch.size());
    const Status stored = database_.StoreStrokes(replay.run.id, batch);
    batch.clear();
    return stored;
  };
  LogPassHooks hooks = KnownOf(replay.log);
  hooks.after_block = [&] { return store(kStrokesPerTransaction); };
  auto pass = TRY(PassLog(reader, machine_, &pipeline, what, hooks));
  TRY(store(1));
  replay.summary = std::move(pass.summary);
  const LogStrokes judged = first.Finish(pipeline);
  const LogTrust trust = JudgeStrokes(judged);
  const NoiseScales noise = NoiseScalesOf(judged, trust);
  replay.summary.noise_scale = noise.noise;
  replay.summary.evidence_scale = noise.evidence;
  if (noise.noise != 1) replay.summary.floor_scale = noise.floor;
  replay.summary.warnings = InEnglish(trust.Warnings());
  if (!pass.no_verdict.empty()) replay.summary.warnings.push_back(pass.no_verdict.english);
  replay.summary.impossible = pass.swapped.empty() ? pass.no_verdict.english : pass.swapped.front().english;
  for (const auto& texts : {pass.reversed, pass.wrong_answers})
    for (const Told& text : texts) replay.summary.warnings.push_back(text.english);
  for (const Told& text : pass.outside_declared) replay.summary.warnings.push_back(text.english);
  for (const ReadingFaults::Echo& echo : pass.echoes)
    replay.summary.warnings.push_back(echo.Sentence().english);
  for (const Told& swapped : pass.swapped) replay.summary.warnings.push_back(swapped.english);
  for (const Told& text : pass.LeftOut(machine_)) replay.summary.warnings.push_back(text.english);
  // Seen only when the log was over.
  const auto late = std::ranges::find(pass.cut_offs, true, &CutOff::narrow);
  if (hooks.known_cut_offs.empty() && late != pass.cut_offs.end() && replay.summary.impossible.empty())
    replay.summary.impossible = late->text.english;
  if (hooks.known_frozen.empty() && !pass.frozen.empty() && replay.summary.impossible.empty())
    replay.summary.impossible = FrozenTexts(pass.frozen, machine_).front().english;
  if (!reversed.empty()) {
    replay.summary.warnings.push_back(reversed.english);
    if (replay.summary.impossible.empty()) replay.summary.impossible = reversed.english;
  }
  for (const Told& doubt : InputDoubts(replay.log, machine_))
    replay.summary.warnings.push_back(doubt.english);
  if (silent > 0 && InEpisodes(KindOf(machine_)))
    replay.summary.warnings.push_back(
        fmt::format("{} of {} tell of no parameter ({}); 'hydroscope fit' of this log says more", silent,
                    CountedWordsOf(machine_).Counted(strokes), SilentEpisode(machine_)));
  if (const Told broken = BrokenUp(pass.channels, machine_, strokes, replay.summary.discarded_strokes);
      !broken.empty())
    replay.summary.warnings.push_back(broken.english);
  if (!trust.rate.fast_enough) replay.summary.too_slow = trust.rate.sentence.english;
  replay.notes.insert(replay.notes.end(), replay.summary.warnings.begin(), replay.summary.warnings.end());
  TRY(database_.FinishRun(replay.run.id, FormatRunSummary(replay.summary), pipeline.SaveState()));
  replay.run.strokes = strokes;
  replay.run.complete = true;
  if (collector) Take(*collector, replay);
  return {};
}

void AxisReplay::Take(ReportCollector& collector, const LogReplay& replay) {
  overlays_ = collector.overlays.Choose(replay.run.first_sequence);
  for (StrokeOverlay& overlay : overlays_) {
    overlay.unit = OutputUnit(machine_);
    overlay.noise_floor *= std::sqrt(replay.summary.floor_scale.value_or(1));
  }
  strokes_ = collector.strokes.Finish(collector.pipeline);
  overlay_run_ = replay.run.id;
}

/// Episodes have no flows to lay over each other.
bool AxisReplay::ShowsStretches() const { return !InEpisodes(KindOf(machine_)); }

/// If the last log had been replayed before, it is read again for its overlays; nothing is stored.
Status AxisReplay::CollectOverlays(const ReplayOutcome& outcome) {
  if (!ShowsStretches()) return {};
  const LogReplay* last = nullptr;
  for (const LogReplay& replay : outcome.logs)
    if (replay.status != ReplayStatus::kFailed && replay.run.strokes > 0) last = &replay;
  if (last == nullptr || last->run.id == overlay_run_) return {};
  std::string note;
  auto reader = TRY(Open(last->log, note));
  std::optional<ReportCollector> collector;
  auto pipeline = TRY(Pipeline::Create(machine_, reader->SamplePeriod(),
                                       [&](StrokeRecord&& record) { collector->AddStroke(record); }));
  collector.emplace(*pipeline, machine_);
  const auto state = TRY(database_.PipelineStateBefore(last->run.id));
  if (state) static_cast<void>(pipeline->RestoreState(*state));  // as the run itself: anew if it does not fit
  const auto pass =
      TRY(PassLog(*reader, machine_, pipeline.get(), "overlay for the report", KnownOf(last->log)));
  Take(*collector, *last);
  return {};
}

/// What changed within the log shown, whose strokes explained as one would mix before and after. False: nothing did.
bool AxisReplay::AddChange(const ReplayOutcome& outcome, ReportInput& input) const {
  for (const RunInfo& run : outcome.runs) {
    if (run.id != overlay_run_) continue;
    const HistoryPart part{machine_.name, machine_id_, run.first_sequence, run.first_sequence + run.strokes};
    if (!FindStoredChange(database_, part, machine_, input.alarms)) return false;
    AddStoredExplanation(database_, options_.database, part, machine_, input);
    return true;
  }
  return false;
}

void AxisReplay::LookForChange(ReplayOutcome& outcome) const {
  if (outcome.runs.size() < 2) return;
  const HistoryPart part = OfNewestVersion({machine_.name, machine_id_, 0, outcome.strokes}, outcome.runs);
  const auto change = FindStoredChange(database_, part, machine_, outcome.watch.alarms);
  if (!change) return;
  const auto log = LogThatBegins(database_, part, *change);
  const bool new_now = log && std::ranges::any_of(outcome.logs, [&](const LogReplay& replay) {
                         return replay.run.id == log->id && replay.status != ReplayStatus::kAlready;
                       });
  if (!new_now) return;
  const CountedWords counted = CountedWordsOf(machine_);
  outcome.stated.unusual.push_back(Tell("The {} of this database hold a change {}. {}",
                                        "Die {} dieser Datenbank enthalten eine Änderung {}. {}",
                                        counted.Several(), change->text, AnotherMachineText(*log, counted)));
}

Status AxisReplay::Report(ReplayOutcome& outcome) {
  if (report_.empty() || outcome.runs.empty()) return {};
  TRY(CollectOverlays(outcome));
  auto input = TRY(MakeReportInput(database_, machine_id_, outcome, std::move(overlays_)));
  input.alarms = outcome.watch.alarms;
  input.drift_verdict = outcome.watch.verdict_html;
  input.drift = outcome.watch.section_html;
  if (strokes_ && !AddChange(outcome, input)) {
    const auto explained = ExplainStrokes(std::move(*strokes_));
    for (const RunInfo& run : outcome.runs)
      if (explained && run.id == overlay_run_)
        AddExplanation(*explained,
                       WhichStrokes(input, {machine_.name, machine_id_, run.first_sequence,
                                            run.first_sequence + run.strokes}),
                       input);
  }
  outcome.report = report_;
  return WriteReport(report_, input);
}

}  // namespace hydroscope
