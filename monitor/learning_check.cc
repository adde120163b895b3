#include "monitor/learning_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/told_error.h"
#include "models/closed_loop.h"
#include "models/counted_words.h"
#include "models/machine_kind.h"
#include "pipeline/doubtful_estimates.h"
#include "pipeline/episodes.h"
#include "pipeline/log_faults/physical_sizes.h"
#include "pipeline/log_faults/usual_modulus.h"
#include "pipeline/log_trust.h"
#include "pipeline/raw_log.h"
#include "pipeline/run_summary.h"
#include "workbench/explain/explain_history.h"
#include "workbench/history/stored_change.h"
#include "workbench/history/trend_analysis.h"

namespace hydroscope {
namespace {

using Kind = LearningDoubt::Kind;
/// Strokes whose sizes are looked at, evenly spread.
constexpr std::int64_t kLooked = 200;
constexpr std::int64_t kMostSummaries = 100'000;
constexpr std::int64_t kStrokesWhoseRowsAreLookedAt = 20;
constexpr std::int64_t kStrokesAtOnce = 4096;  ///< whose estimates are read
constexpr std::array<const char*, 10> kDoubtNames = {
    "model_versions", "open_alarm", "change",      "implausible", "reversed",
    "too_slow",       "effect",     "odd_strokes", "unexplained", "not_explained"};

std::vector<LearningDoubt> OfModelVersions(const Database& database, const HistoryPart& part) {
  const auto runs = database.Runs(part.id);
  if (!runs) return {};
  std::set<int> versions;
  for (const RunInfo& run : *runs)
    if (run.first_sequence < part.last && run.first_sequence + run.strokes > part.first)
      versions.insert(run.model_version);
  if (versions.size() < 2) return {};
  return {
      {Kind::kModelVersions,
       Tell(
           "they were recorded with versions {} of the model: choose those of one version with --from and --to",
           "sie wurden mit den Versionen {} des Modells aufgezeichnet: die einer Version wählen (--from, --to)",
           fmt::format("{}", fmt::join(versions, ", ")))}};
}

std::vector<LearningDoubt> OfAlarms(const std::vector<AlarmState>& alarms, const HistoryPart& part,
                                    const CountedWords& counted) {
  std::vector<LearningDoubt> doubts;
  for (const AlarmState& alarm : alarms)
    if (TellsAChange(alarm) && alarm.first_stroke < part.last)
      doubts.push_back(
          {Kind::kOpenAlarm,
           Tell("the alarm {} stands since {} {}: {}", "der Alarm {} steht seit {} {} an: {}", alarm.id,
                counted.One(), alarm.first_stroke, Told{alarm.text, alarm.words.finding.german})});
  return doubts;
}

std::vector<LearningDoubt> OfVerdict(const Result<ExplainResult>& result, bool noise_known) {
  if (!result)
    return {{Kind::kNotExplained, Tell("they could not be explained: {}",
                                       "sie ließen sich nicht erklären: {}", result.error().text)}};
  const Explanation& x = result->explanation;
  if (!x.no_verdict.empty())
    return {{Kind::kUnexplained,
             Tell("'explain' gives no verdict on them: {}", "'explain' gibt kein Urteil über sie: {}",
                  x.no_verdict),
             true}};
  const Told proven = x.partial ? Told(" (not proven)", " (nicht bewiesen)") : Told{};
  switch (x.verdict) {
    case Verdict::kAdequate:
      return {};
    case Verdict::kNamed:
      return {{Kind::kEffect, Tell("'explain' finds in them: {}{}", "'explain' findet in ihnen: {}{}",
                                   fmt::format("{}", fmt::join(x.set, ", ")), proven)}};
    case Verdict::kAmbiguous:
      return {{Kind::kEffect,
               Tell("'explain' finds in them one of: {}{}", "'explain' findet in ihnen eines von: {}{}",
                    fmt::format("{}", fmt::join(x.set, ", ")), proven)}};
    case Verdict::kUnknown:
      break;
  }
  if (x.small_error)
    return {{Kind::kUnexplained,
             Tell("'explain' says UNKNOWN, a small error is left: {}",
                  "'explain' sagt UNBEKANNT, ein kleiner Fehler bleibt: {}", x.doubt),
             true}};
  return {
      {Kind::kUnexplained,
       Tell(
           "'explain' says UNKNOWN: the model errs in them by more than noise, and no effect explains it",
           "'explain' sagt UNBEKANNT: das Modell irrt in ihnen um mehr als das Rauschen, und kein Effekt erklärt es"),
       x.may_be_noise || !noise_known || KindOf(result->log.machine).own_library}};
}

/// Drift is relative, so a scale that is wrong throughout is said and stops nothing.
std::vector<LearningDoubt> OfParameters(const Machine& machine, const ExplainResult& result) {
  std::vector<LearningDoubt> doubts;
  for (Told& unusual : UnusualParameters(machine, result.base.parameters))
    doubts.push_back({Kind::kUnexplained, std::move(unusual), true});
  return doubts;
}

/// Where the model describes all but a few strokes, these are none of the healthy machine: a sensor that stood still for a while,
/// or what went on in one bad stretch.
std::vector<LearningDoubt> OfOddStrokes(const StrokeHistory& history, const Explanation& x) {
  const auto parted = ButForOddUnits(history, x);
  if (!parted || parted->odd_strokes.empty()) return {};
  std::vector<std::string> odd;
  for (const OddStrokes& some : parted->odd_strokes)
    for (const std::size_t unit : some.strokes) {
      const HistoryPart& part = history.unit_parts[unit];
      odd.push_back(part.strokes() == 1 ? fmt::format("{}", part.first)
                                        : fmt::format("{} ... {}", part.first, part.last - 1));
    }
  return {
      {Kind::kOddStrokes,
       Tell(
           "a few of them differ from the others, which the model describes: {}. Leave them out with --from and --to",
           "einige wenige weichen von den übrigen ab, die das Modell beschreibt: {}. Ohne sie lernen (--from, --to)",
           fmt::format("{}", fmt::join(odd, ", ")))}};
}

/// What of a live run the raw window may still hold: its newest strokes within `part`.
std::vector<StrokeSummary> NewestOf(const Database& database, const HistoryPart& part, const RunInfo& run) {
  const std::int64_t last = std::min(part.last, run.first_sequence + run.strokes);
  const std::int64_t first = std::max({part.first, run.first_sequence, last - kStrokesWhoseRowsAreLookedAt});
  return database.SummariesOf(part.id, first, last, kLooked).value_or(std::vector<StrokeSummary>());
}

/// Why the rows of a live run are too far apart, judged by those kept of its newest strokes within `part`; "" if they
/// are not, or none are kept.
Told SlowRowsKept(const Database& database, const std::string& path, const HistoryPart& part,
                  const RunInfo& run, const Machine& machine) {
  const auto strokes = NewestOf(database, part, run);
  if (strokes.empty()) return {};
  auto rows = OpenRawRun(path, run.id, strokes.front().begin, strokes.back().end, machine);
  if (!rows) return {};
  const auto trust = JudgeRows(**rows, machine);
  return trust && !trust->rate.fast_enough ? trust->rate.sentence : Told{};
}

/// That a signal of a machine with states counts the other way round in these rows; "" if it does not, or none are kept.
Told ReversedRowsKept(const Database& database, const std::string& path, const HistoryPart& part,
                      const RunInfo& run, const Machine& machine) {
  const auto strokes = NewestOf(database, part, run);
  if (strokes.empty()) return {};
  const std::string rows =
      fmt::format("{}#{}/{}@={}:{}", path, part.machine.substr(part.machine.rfind('/') + 1), run.id,
                  strokes.front().begin, strokes.back().end);
  const Status signs = JudgeSigns(rows, machine);
  return signs ? Told() : ToldOf(signs.error());
}

/// What the estimates of the last of these strokes say whose signals count the other way round.
std::optional<LearningDoubt> OfReversed(const Database& database, const HistoryPart& part,
                                        const Machine& machine) {
  if (ClosedLoopOf(machine) == nullptr) return std::nullopt;
  for (std::int64_t end = part.last; end > part.first; end -= kStrokesAtOnce) {
    const auto trend = database.Trend(part.id, "", std::max(part.first, end - kStrokesAtOnce), end);
    if (!trend) return std::nullopt;
    std::vector<Estimate> of_one;
    for (auto point = trend->rbegin(); point != trend->rend(); ++point) {
      of_one.insert(of_one.begin(), point->estimate);
      if (const auto before = std::next(point);
          before != trend->rend() && before->sequence == point->sequence)
        continue;
      if (Told reversed = ReversedIn(machine, of_one); !reversed.empty())
        return LearningDoubt{
            .kind = Kind::kReversed, .text = std::move(reversed), .refused_to = point->sequence + 1};
      of_one.clear();
    }
  }
  return std::nullopt;
}

/// Whether the strokes' error grew by more than a model may err, at equal oil temperature where that was measured.
bool ErrorGrew(const std::vector<StrokeSummary>& strokes, const ThirdsComparison& ratio) {
  if (SignificanceOf(ratio.change) != Significance::kClear) return false;
  if (!(ratio.last * ratio.last > (1 + ExplainOptions{}.floor_excess) * ratio.first * ratio.first))
    return false;
  std::vector<double> ratios, oil, number;
  for (const StrokeSummary& stroke : strokes) {
    if (!(stroke.noise_floor > 0) || !std::isfinite(stroke.rms_error + stroke.oil_temperature)) continue;
    ratios.push_back(stroke.rms_error / stroke.noise_floor);
    oil.push_back(stroke.oil_temperature);
    number.push_back(static_cast<double>(stroke.index));
  }
  const auto [coldest, warmest] = std::ranges::minmax_element(oil);
  if (oil.empty() || *coldest == *warmest) return true;
  const CorrelatedFit fit =
      FitCorrelated({std::vector<double>(ratios.size(), 1.0), oil, number}, ratios, {}, 0);
  return !fit.coefficients.empty() && fit.coefficients[2].value > 0 &&
         SignificanceOf(fit.coefficients[2]) == Significance::kClear;
}

/// Where the model errs, a parameter that moved or an error that grew, and not with the oil, is a machine that changed,
/// too slowly to say where; `placed`: where, is told already.
std::vector<LearningDoubt> OfTrends(const Database& database, const HistoryPart& part, const Machine& machine,
                                    bool placed) {
  auto strokes = database.SummariesOf(part.id, part.first, part.last, kMostSummaries);
  if (!strokes) return {};
  auto trends = database.Trend(part.id, "", part.first, part.last);
  auto blocks = EstimateBlocks(database, part.id, machine, *strokes);
  if (!trends || !blocks) return {};
  const RecordedHistory record{machine, {}, std::move(*strokes), std::move(*trends), std::move(*blocks)};
  const TrendAnalysis analysis = AnalyseTrends(record);
  if (!placed && ErrorGrew(record.strokes, analysis.error.ratio))
    return {
        {Kind::kChange,
         Tell(
             "they hold a change: the error of the model grew over them, from {:.1f} to {:.1f} times the noise",
             "in ihnen liegt eine Änderung: der Fehler des Modells wuchs über sie hinweg, vom {:.1f}- auf das "
             "{:.1f}-Fache des Rauschens",
             analysis.error.ratio.first, analysis.error.ratio.last)}};
  std::vector<std::string> moved;
  for (const ParameterAnalysis& parameter : analysis.parameters)
    if (parameter.unexplained == Significance::kClear) moved.push_back(parameter.parameter);
  if (moved.empty()) return {};
  return {{Kind::kChange,
           Tell("they hold a change: {} moved over them, and not with the oil",
                "in ihnen liegt eine Änderung: {} hat sich über sie hinweg bewegt, und nicht mit dem Öl",
                fmt::format("{}", fmt::join(moved, ", ")))}};
}

void Append(std::vector<LearningDoubt>& all, std::vector<LearningDoubt> more) {
  all.insert(all.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

}  // namespace

const char* LearningDoubtName(Kind kind) { return kDoubtNames[static_cast<std::size_t>(kind)]; }

std::optional<LearningDoubt> DoubtOfSignals(const Database& database, const std::string& path,
                                            const HistoryPart& part, const Machine& machine) {
  const auto sample = database.SummariesOf(part.id, part.first, part.last, kLooked);
  if (sample)
    if (const Status plausible = JudgeStrokes(path, machine, *sample); !plausible)
      return LearningDoubt{.kind = Kind::kImplausible, .text = ToldOf(plausible.error())};
  if (auto reversed = OfReversed(database, part, machine)) return reversed;
  const auto runs = database.Runs(part.id);
  if (!runs) return std::nullopt;
  for (const RunInfo& run : *runs) {
    if (run.first_sequence >= part.last || run.first_sequence + run.strokes <= part.first) continue;
    const RunSummary summary = ParseRunSummary(run.summary_json);
    const auto refused = [&](Kind kind, const Told& why) {
      return LearningDoubt{.kind = kind,
                           .text = Tell("run {} ({}): {}", "Lauf {} ({}): {}", run.id, run.source, why),
                           .refused_to = std::min(part.last, run.first_sequence + run.strokes)};
    };
    if (!summary.impossible.empty()) return refused(Kind::kImplausible, Told(summary.impossible));
    const bool live = run.source == kLiveSource;
    const Told slow = live ? SlowRowsKept(database, path, part, run, machine) : Told(summary.too_slow);
    if (!slow.empty()) return refused(Kind::kTooSlow, slow);
    if (!live || !KindOf(machine).has_states) continue;
    if (const Told reversed = ReversedRowsKept(database, path, part, run, machine); !reversed.empty())
      return refused(Kind::kReversed, reversed);
  }
  return std::nullopt;
}

std::vector<LearningDoubt> DoubtsOfLearning(const Database& database, const std::string& path,
                                            const HistoryPart& part, const Machine& machine,
                                            const std::vector<AlarmState>& alarms) {
  std::vector<LearningDoubt> doubts = OfModelVersions(database, part);
  Append(doubts, OfAlarms(alarms, part, CountedWordsOf(machine)));
  if (const auto change = FindStoredChange(database, part, machine, {}))
    doubts.push_back(
        {Kind::kChange, Tell("they hold a change {}", "in ihnen liegt eine Änderung: {}", change->text)});
  if (auto doubt = DoubtOfSignals(database, path, part, machine)) {
    doubts.push_back(std::move(*doubt));
    return doubts;
  }
  const auto history = LoadHistory(database, path, {part}, machine);
  const auto result =
      history ? ExplainHistory(*history) : Result<ExplainResult>(tl::unexpected(history.error()));
  Append(doubts, OfVerdict(result, !history || history->noise_known));
  if (result) Append(doubts, OfOddStrokes(*history, result->explanation));
  if (result) Append(doubts, OfParameters(machine, *result));
  const auto are_there = [&](Kind kind) {
    return std::ranges::find(doubts, kind, &LearningDoubt::kind) != doubts.end();
  };
  if (are_there(Kind::kUnexplained))
    Append(doubts, OfTrends(database, part, machine, are_there(Kind::kChange)));
  return doubts;
}

Told DoubtText(const std::vector<LearningDoubt>& doubts, bool doubtful_only) {
  std::vector<Told> sentences;
  for (const LearningDoubt& doubt : doubts)
    if (!doubtful_only || doubt.MakesDoubtful()) sentences.push_back(doubt.text);
  return Joined(sentences, "; ");
}

}  // namespace hydroscope
