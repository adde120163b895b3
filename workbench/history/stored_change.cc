#include "workbench/history/stored_change.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/distributions.h"
#include "models/counted_words.h"
#include "storage/alarm_journal.h"
#include "workbench/history/block_estimates.h"

namespace hydroscope {
namespace {

constexpr std::size_t kFewestValues = 8, kFewestOfALevel = 3;
/// Asked of a change before anybody is told of it unasked: it must be evident, not merely significant.
constexpr double kEvident = 1e-4;
constexpr double kBetterThanALine = 0.5;
constexpr std::int64_t kOilSample = 2000;  ///< strokes whose oil temperature is read

double SquaresAboutMean(const double* first, const double* last) {
  const auto n = static_cast<double>(last - first);
  const double mean = std::accumulate(first, last, 0.0) / n;
  return std::accumulate(first, last, 0.0,
                         [&](double sum, double v) { return sum + (v - mean) * (v - mean); });
}

double MeanOf(const double* first, const double* last) {
  return std::accumulate(first, last, 0.0) / static_cast<double>(last - first);
}

/// Squares left by a straight line over x; infinite if x is not known everywhere or does not vary.
double SquaresAboutLine(const std::vector<double>& x, const std::vector<double>& y) {
  const double none = std::numeric_limits<double>::infinity();
  if (x.size() != y.size() || !std::ranges::all_of(x, [](double v) { return std::isfinite(v); })) return none;
  const double mean_x = MeanOf(x.data(), x.data() + x.size()), mean_y = MeanOf(y.data(), y.data() + y.size());
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
    yy += (y[i] - mean_y) * (y[i] - mean_y);
  }
  return xx > 0 ? yy - xy * xy / xx : none;
}

/// One parameter over the blocks that determine it.
struct BlockSeries {
  std::string parameter;
  std::vector<double> values, oil;
  std::vector<const BlockEstimates*> blocks;
};

std::vector<BlockSeries> SeriesOfParameters(const std::vector<BlockEstimates>& blocks) {
  std::vector<BlockSeries> all;
  for (const BlockEstimates& block : blocks)
    for (const Estimate& estimate : block.parameters) {
      if (estimate.reason != EstimateReason::kUpdated || !std::isfinite(estimate.value)) continue;
      auto series =
          std::ranges::find_if(all, [&](const BlockSeries& s) { return s.parameter == estimate.parameter; });
      if (series == all.end()) series = all.insert(all.end(), {estimate.parameter, {}, {}, {}});
      series->values.push_back(estimate.value);
      series->oil.push_back(block.oil_temperature);
      series->blocks.push_back(&block);
    }
  return all;
}

/// The change may lie in the blocks at either side of the place found; these are left out where enough remain.
StoredChange ChangeAt(const BlockSeries& series, const LevelChange& change, const CountedWords& counted) {
  const std::size_t n = series.blocks.size();
  const std::size_t last_before = change.at > kFewestOfALevel ? change.at - 1 : change.at;
  const std::size_t first_after = n - change.at > kFewestOfALevel ? change.at + 1 : change.at;
  StoredChange found;
  found.before_end = series.blocks[last_before]->first;
  found.since = series.blocks[first_after]->first;
  found.by = series.parameter;
  found.text = Tell("between {} {} and {}, where {} changes its level",
                    "zwischen {} {} und {}, wo {} die Höhe wechselt", counted.Many(), found.before_end,
                    found.since, series.parameter);
  return found;
}

bool LeavesEnough(const StoredChange& change, const HistoryPart& part) {
  return change.before_end - part.first >= kFewestOnASide && part.last - change.since >= kFewestOnASide;
}

std::optional<StoredChange> ToldByAlarm(const HistoryPart& part, const std::vector<AlarmState>& alarms,
                                        const CountedWords& counted) {
  std::optional<StoredChange> earliest;
  for (const AlarmState& alarm : alarms) {
    if (!TellsAChange(alarm)) continue;
    StoredChange change{alarm.first_stroke, alarm.first_stroke, alarm.id,
                        Tell("since {} {}, told by the alarm {}", "seit {} {}, wie der Alarm {} sagt",
                             counted.One(), alarm.first_stroke, alarm.id)};
    if (LeavesEnough(change, part) && (!earliest || change.since < earliest->since))
      earliest = std::move(change);
  }
  return earliest;
}

std::optional<StoredChange> EvidentInBlocks(const Database& database, const HistoryPart& part,
                                            const Machine& machine) {
  const auto strokes = database.SummariesOf(part.id, part.first, part.last, kOilSample);
  if (!strokes || strokes->empty()) return std::nullopt;
  const auto blocks = EstimateBlocks(database, part.id, machine, *strokes);
  if (!blocks) return std::nullopt;
  std::optional<StoredChange> clearest;
  double p = kEvident;
  for (const BlockSeries& series : SeriesOfParameters(*blocks)) {
    const auto change = FindLevelChange(series.values, {series.oil});
    if (!change || !(change->p < p)) continue;
    StoredChange found = ChangeAt(series, *change, CountedWordsOf(machine));
    if (!LeavesEnough(found, part)) continue;
    p = change->p;
    clearest = std::move(found);
  }
  return clearest;
}

}  // namespace

bool TellsAChange(const AlarmState& alarm) {
  return alarm.active && alarm.first_stroke >= 0 && alarm.severity != AlarmSeverity::kSignalLoss &&
         !alarm.id.starts_with("slow_") && alarm.id != "doubtful_reference" &&
         alarm.id.find('.') == std::string::npos;
}

std::optional<LevelChange> FindLevelChange(const std::vector<double>& values,
                                           const std::vector<std::vector<double>>& others) {
  const std::size_t n = values.size();
  if (n < kFewestValues) return std::nullopt;
  const double *first = values.data(), *last = first + n;
  LevelChange best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t at = kFewestOfALevel; at + kFewestOfALevel <= n; ++at) {
    const double left = SquaresAboutMean(first, first + at) + SquaresAboutMean(first + at, last);
    if (left >= least) continue;
    least = left;
    best.at = at;
  }
  best.before = MeanOf(first, first + best.at);
  best.after = MeanOf(first + best.at, last);
  std::vector<double> numbers(n);
  std::iota(numbers.begin(), numbers.end(), 0.0);
  double line = SquaresAboutLine(numbers, values);
  for (const std::vector<double>& other : others) line = std::min(line, SquaresAboutLine(other, values));
  if (!(least <= kBetterThanALine * line)) return std::nullopt;
  const double degrees = static_cast<double>(n) - 2;
  const double std_error =
      std::sqrt(least / degrees * (1 / static_cast<double>(best.at) + 1 / static_cast<double>(n - best.at)));
  const double t = std::abs(best.after - best.before) / std::max(std_error, 1e-300);
  const auto places = static_cast<double>(n - 2 * kFewestOfALevel + 1);
  best.p = std::min(1.0, places * StudentTwoSided(t, degrees));
  if (!(best.p < kEvident)) return std::nullopt;
  return best;
}

std::optional<StoredChange> FindStoredChange(const Database& database, const HistoryPart& part,
                                             const Machine& machine, const std::vector<AlarmState>& alarms) {
  if (auto told = ToldByAlarm(part, alarms, CountedWordsOf(machine))) return told;
  return EvidentInBlocks(database, part, machine);
}

Told WarningOfBothSides(const StoredChange& change, const CountedWords& counted) {
  return Tell(
      "these {} hold a change {}: one model for both sides of it errs on either; look at "
      "each with --to {} and --from {}",
      "in diesen {} liegt eine Änderung {}: ein Modell für beide Seiten irrt auf jeder; jede für "
      "sich zeigen --to {} und --from {}",
      counted.SeveralDative(), change.text, change.before_end, change.since);
}

std::vector<AlarmState> AlarmsBeside(const std::string& database, const std::string& machine) {
  const auto journal = AlarmJournal::OpenExisting(AlarmJournal::PathFor(database));
  if (!journal) return {};
  auto axis = journal->Axis(machine);
  return axis ? std::move(axis->alarms) : std::vector<AlarmState>();
}

}  // namespace hydroscope
