#include "review/replay_report.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/quantile.h"
#include "models/counted_words.h"
#include "models/machine_kind.h"
#include "workbench/explain/headline.h"
#include "workbench/model/model_record.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kMostStrokesFitted = 400;

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

/// Of a machine that is followed from episode to episode, each was predicted with the parameters as they stood before it. Medians over
/// the last run; no fit.
Status TakeErrorsOfEpisodes(const Database& database, const RunInfo& run, ReplayOutcome& outcome) {
  const auto episodes = TRY(database.Strokes(run.id));
  std::vector<double> errors, floors;
  for (const StrokeSummary& episode : episodes) {
    errors.push_back(episode.rms_error);
    floors.push_back(episode.noise_floor);
  }
  outcome.figures.rms_holdout = Median(errors, 0);
  outcome.figures.noise_floor = Median(floors, 0);
  return {};
}

/// Error of the model on strokes left out, from the last run (of very many strokes, the last ones).
Status FitLastRun(const Database& database, std::int64_t machine_id, const ModelStructure& model,
                  ReplayOutcome& outcome) {
  const auto run = std::find_if(outcome.runs.rbegin(), outcome.runs.rend(),
                                [](const RunInfo& r) { return r.complete && r.strokes > 0; });
  if (run == outcome.runs.rend()) return {};
  if (InEpisodes(KindOf(outcome.machine))) return TakeErrorsOfEpisodes(database, *run, outcome);
  const std::int64_t end = run->first_sequence + run->strokes;
  const auto grams =
      TRY(database.Grams(machine_id, std::max(run->first_sequence, end - kMostStrokesFitted), end));
  const double period = ParseRunSummary(run->summary_json).sample_period;
  if (!(period > 0) || grams.empty() || grams.front().flow.dimension() != model.column_count()) return {};
  WindowSamples window = WindowSamples::From(outcome.machine.window, period);
  window.level_form = model.level_form;
  StrokeHistory history;
  auto structure = TRY(BuildModel(outcome.machine));
  history.machine = outcome.machine;
  history.model = std::move(structure);
  history.window = window;
  history.units = std::move(grams);
  const auto fitted = FitHistoryModel(outcome.machine, history);
  if (!fitted) return {};  // too little excitation is told parameter by parameter
  outcome.figures = fitted->figures;
  return {};
}

/// The recursive estimate takes strokes for independent. Where those of the last run hang together, its intervals are at
/// least those of the fit to them.
void WidenByLastRun(ReplayOutcome& outcome) {
  if (outcome.figures.clusters.unit == ClusterUnit::kStroke) return;
  for (Estimate& latest : outcome.latest)
    for (const Estimate& fitted : outcome.figures.parameters)
      if (fitted.parameter == latest.parameter && std::isfinite(fitted.std) && fitted.std > latest.std) {
        latest.std = fitted.std;
        if (fitted.reason == EstimateReason::kConfounded && latest.reason == EstimateReason::kUpdated)
          latest.reason = fitted.reason;
      }
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
  TRY(FitLastRun(database, machine_id, model, outcome));
  WidenByLastRun(outcome);
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
    for (StrokeSummary& stroke : strokes) {
      stroke.index += run.first_sequence;
      input.strokes.push_back(stroke);
    }
    input.rows += ParseRunSummary(run.summary_json).rows;
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
  input.noise_floor = outcome.figures.noise_floor;
  input.rms_holdout = outcome.figures.rms_holdout;
  if (outcome.figures.strokes > 0) input.not_judged = ImpossibleFigures(outcome.figures).english;
  return input;
}

}  // namespace hydroscope
