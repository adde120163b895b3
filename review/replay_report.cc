#include "review/replay_report.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "models/counted_words.h"
#include "models/machine_kind.h"
#include "pipeline/log_faults/stuck_signal.h"
#include "workbench/explain/headline.h"
#include "workbench/model/model_record.h"

namespace hydroscope {
namespace {

const char* FlagWhy(const std::string& flag) {
  static const std::map<std::string, const char*> kWhy = {
      {"missing", "empty field, NaN or infinity"},
      {"stuck", "the very same reading for too long"},
      {"spike", "a single reading far off both neighbours"},
      {"out_of_range", "outside min/max of the machine file, or at the end of the sensor"},
      {"gap", "rows are missing before this one"},
      {"time_backwards", "time stamp not after the one before"},
      {"clock_jump", "the clock stepped"},
      {"duplicate", "the same time stamp again"},
      {"late", "arrived too late"},
      {"offset_drift", "the zero of the channel wandered off"},
      {"stale", "the last reading is too old"},
      {"future", "beyond what the sender's clock allows"}};
  const auto why = kWhy.find(flag);
  return why == kWhy.end() ? "" : why->second;
}

/// Flags that belong to the time stamp: one per row, whatever the number of channels.
bool IsTimeFlag(const std::string& flag) {
  return flag == "gap" || flag == "time_backwards" || flag == "clock_jump" || flag == "duplicate" ||
         flag == "late";
}

/// Sums over the runs of a machine.
struct Sums {
  std::int64_t rows = 0, rejected = 0, outside = 0, unused = 0, discarded = 0;
  std::map<std::pair<std::string, std::string>, std::int64_t> channel_flag;
  std::map<std::string, std::int64_t> time_flag;
  std::vector<SkippedItem> stopped;
};

void AddRun(const RunInfo& run, Sums& sums) {
  const RunSummary s = ParseRunSummary(run.summary_json);
  sums.rows += s.rows;
  sums.rejected += s.rejected_rows;
  sums.outside += s.rows - s.gated;
  sums.unused += s.gated - s.used;
  sums.discarded += s.discarded_strokes;
  std::map<std::string, std::int64_t> time_flag;
  for (const auto& [channel, flags] : s.flagged)
    for (const auto& [flag, count] : flags) {
      if (IsTimeFlag(flag))
        time_flag[flag] = std::max(time_flag[flag], count);
      else
        sums.channel_flag[{channel, flag}] += count;
    }
  for (const auto& [flag, count] : time_flag) sums.time_flag[flag] += count;
  if (!s.stopped.empty()) sums.stopped.push_back({"rest of " + run.source, 0, s.stopped});
  if (run.abandoned)
    sums.stopped.push_back(
        {"rest of " + run.source, 0, "its replay was stopped and later logs were replayed since"});
}

std::vector<SkippedItem> Skipped(const Sums& sums, const Machine& machine,
                                 const std::vector<LogReplay>& logs) {
  std::vector<SkippedItem> skipped;
  const CountedWords counted = CountedWordsOf(machine);
  for (const LogReplay& log : logs)
    if (log.status == ReplayStatus::kFailed) skipped.push_back({"log " + log.log, 0, log.problem});
  skipped.insert(skipped.end(), sums.stopped.begin(), sums.stopped.end());
  const auto add = [&](const std::string& what, std::int64_t rows, const std::string& why) {
    if (rows > 0) skipped.push_back({what, rows, why});
  };
  add("rows that could not be read", sums.rejected, "torn, or another number of fields than the header");
  for (const auto& [flag, count] : sums.time_flag)
    add(fmt::format("rows flagged {}", flag), count, FlagWhy(flag));
  for (const auto& [key, count] : sums.channel_flag)
    add(fmt::format("values flagged {}, {}", key.second, key.first), count, FlagWhy(key.second));
  add(fmt::format("{} too short", counted.many), sums.discarded,
      "shorter than min_stroke in [gate] of the machine file");
  add("rows outside the gate", sums.outside,
      fmt::format("the model describes the {} only ([gate] conditions)", WordsOf(machine).stroke.english));
  add("rows inside the gate, not used", sums.unused,
      fmt::format("too few in a row for an equation: end of {}, or beside a bad value",
                  counted.with_article));
  return skipped;
}

/// Parameters after the last stroke that has any.
std::vector<Estimate> LatestOf(const std::vector<TrendPoint>& trend) {
  std::vector<Estimate> latest;
  if (trend.empty()) return latest;
  const std::int64_t last = trend.back().sequence;
  for (const TrendPoint& point : trend)
    if (point.sequence == last) latest.push_back(point.estimate);
  return latest;
}

/// Whether a stroke of the run updated a parameter, or all of them together made one surer.
Result<bool> Taught(const Database& database, std::int64_t machine_id, const RunInfo& run) {
  constexpr std::int64_t kAtATime = 1000;
  const std::int64_t end = run.first_sequence + run.strokes;
  std::map<std::string, std::pair<double, double>>
      stds;  // after the first stroke that has the parameter, after the last
  for (std::int64_t first = run.first_sequence; first < end; first += kAtATime) {
    const auto points = TRY(database.Trend(machine_id, "", first, std::min(end, first + kAtATime)));
    for (const TrendPoint& point : points) {
      const Estimate& e = point.estimate;
      if (e.reason == EstimateReason::kUpdated) return true;
      stds.try_emplace(e.parameter, e.std, e.std).first->second.second = e.std;
    }
  }
  return std::ranges::any_of(stds, [](const auto& of) { return of.second.second < of.second.first; });
}

/// Strokes that are expected to teach something, as many as `check` asks for; the first ones of a model with effects do not.
constexpr std::int64_t kEnoughStrokes = 10;

/// A log of a machine that stood still but for a few strokes teaches nothing, and nobody expects it where logs before it did.
Status FindWhatTaughtNothing(const Database& database, std::int64_t machine_id, const ModelStructure& model,
                             ReplayOutcome& outcome) {
  for (LogReplay& log : outcome.logs) {
    if (log.status == ReplayStatus::kFailed || log.run.strokes == 0) continue;
    const std::int64_t seen =
        log.run.strokes + log.summary.discarded_strokes;  // bad values cut strokes short
    if (seen < kEnoughStrokes && !outcome.latest.empty()) continue;
    if (TRY(Taught(database, machine_id, log.run))) continue;
    const Told stuck = StuckSignal(log.summary, outcome.machine, model);
    log.taught_nothing = fmt::format("none of {} told of a parameter{}{}",
                                     CountedWordsOf(outcome.machine).Counted(log.run.strokes),
                                     stuck.empty() ? "" : "; ", stuck.english);
  }
  return {};
}

}  // namespace

Status CollectOutcome(const Database& database, std::int64_t machine_id, const ModelStructure& model,
                      ReplayOutcome& outcome) {
  outcome.runs = TRY(database.Runs(machine_id));
  Sums sums;
  for (const RunInfo& run : outcome.runs) {
    outcome.strokes += run.strokes;
    AddRun(run, sums);
  }
  outcome.skipped = Skipped(sums, outcome.machine, outcome.logs);
  const auto trend = TRY(database.Trend(machine_id, "", std::max<std::int64_t>(0, outcome.strokes - 1)));
  outcome.latest = LatestOf(trend);
  TRY(FindWhatTaughtNothing(database, machine_id, model, outcome));
  outcome.stated =
      TRY(StateEstimates(database, machine_id, outcome.machine, model, outcome.runs, outcome.latest));
  return {};
}

Result<ReportInput> MakeReportInput(const Database& database, std::int64_t machine_id,
                                    const ReplayOutcome& outcome, std::vector<StrokeOverlay> overlays) {
  ReportInput input;
  std::optional<SkippedItem> unread;
  input.machine = outcome.machine;
  input.runs = outcome.runs;
  for (const RunInfo& run : outcome.runs) {
    auto strokes = TRY(database.Strokes(run.id));
    const RunSummary summary = ParseRunSummary(run.summary_json);
    for (StrokeSummary& stroke : strokes) {
      stroke.index += run.first_sequence;
      stroke.noise_floor *= std::sqrt(summary.floor_scale.value_or(1));  // stored as that of white noise
      input.strokes.push_back(stroke);
    }
    input.rows += summary.rows;
  }
  input.trends = TRY(database.Trend(machine_id, ""));
  if (auto blocks = EstimateBlocks(database, machine_id, outcome.machine, input.strokes); blocks)
    input.blocks = std::move(*blocks);
  else
    unread = SkippedItem{fmt::format("comparison of early and late {}", CountedWordsOf(outcome.machine).many),
                         0, blocks.error().text};
  input.overlays = std::move(overlays);
  input.skipped = outcome.skipped;
  if (unread) input.skipped.push_back(*unread);
  const GramFit& figures = outcome.stated.figures;
  input.noise_floor = figures.noise_floor;
  input.rms_holdout = figures.rms_holdout;
  if (figures.strokes > 0) input.not_judged = ImpossibleFigures(figures).english;
  input.latest = outcome.latest;
  input.confounded = outcome.stated.confounded;
  input.unusual = outcome.stated.unusual;
  return input;
}

}  // namespace hydroscope
