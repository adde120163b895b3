#include "workbench/history/stored_change.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/distributions.h"
#include "estimation/floor_trust.h"
#include "estimation/trend_statistics.h"
#include "models/counted_words.h"
#include "models/machine_kind.h"
#include "storage/alarm_journal.h"
#include "workbench/history/block_estimates.h"

namespace hydroscope {
namespace {

constexpr std::size_t kFewestValues = 8, kFewestOfALevel = 3;
/// Asked of a change before anybody is told of it unasked: it must be evident, not merely significant.
constexpr double kEvident = 1e-4;
constexpr double kBetterThanALine = 0.5;
constexpr std::int64_t kOilSample = 2000;  ///< strokes whose oil temperature and conditions are read
constexpr double kStandsOut = 3;           ///< standard deviations of the values before
constexpr double kEndScatter = 2;          ///< standard deviations of single values, of those of one end
constexpr double kLeastEnergy = 0.1;       ///< of error and noise over noise, which scatters about 1

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

/// Squares that the best of lines over each of `others` leaves.
double SquaresAboutLines(const std::vector<std::vector<double>>& others, const std::vector<double>& y) {
  double least = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& other : others) least = std::min(least, SquaresAboutLine(other, y));
  return least;
}

/// Where two levels leave least of `values`, without a p.
struct BestPlace {
  LevelChange change;
  double squares = std::numeric_limits<double>::infinity();
  double places = 0;  ///< looked at
};

BestPlace FindBestPlace(const std::vector<double>& values) {
  const std::size_t n = values.size();
  const double *first = values.data(), *last = first + n;
  BestPlace best;
  for (std::size_t at = kFewestOfALevel; at + kFewestOfALevel <= n; ++at) {
    const double left = SquaresAboutMean(first, first + at) + SquaresAboutMean(first + at, last);
    if (left >= best.squares) continue;
    best.squares = left;
    best.change.at = at;
  }
  best.change.before = MeanOf(first, first + best.change.at);
  best.change.after = MeanOf(first + best.change.at, last);
  best.places = static_cast<double>(n - 2 * kFewestOfALevel + 1);
  return best;
}

/// p of no change, over all places looked at, of two levels that leave `squares`.
double ChanceOf(const BestPlace& best, std::size_t n) {
  const double degrees = static_cast<double>(n) - 2;
  const auto at = static_cast<double>(best.change.at);
  const double std_error = std::sqrt(best.squares / degrees * (1 / at + 1 / (static_cast<double>(n) - at)));
  const double t = std::abs(best.change.after - best.change.before) / std::max(std_error, 1e-300);
  return std::min(1.0, best.places * StudentTwoSided(t, degrees));
}

/// Standard deviation of single values, of what neighbours differ by: a level that moves adds little to it.
double ScatterOfNeighbours(const std::vector<double>& values) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) steps.push_back(std::abs(values[i] - values[i - 1]));
  std::ranges::nth_element(steps, steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2));
  constexpr double kMedianOfNormal = 0.6745;
  return steps[steps.size() / 2] / kMedianOfNormal / std::sqrt(2.0);
}

/// How many of the first values, kFewestOfALevel at least, are alike.
std::size_t CountAlike(const std::vector<double>& values) {
  const double scatter = ScatterOfNeighbours(values);
  std::size_t count = kFewestOfALevel;
  while (2 * count < values.size() &&
         std::abs(values[count] - MeanOf(values.data(), values.data() + count)) < kEndScatter * scatter)
    ++count;
  return count;
}

/// Whether the value at `last` is beyond those before it.
bool StandsOut(const double* first, const double* last) {
  const double scatter = std::sqrt(SquaresAboutMean(first, last) / static_cast<double>(last - first - 1));
  return *last - MeanOf(first, last) > kStandsOut * scatter;
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

/// What a fit without the effect that changed the machine takes for one of its parameters: no name of what changed.
Told FittedAs(const Machine& machine, const std::string& parameter) {
  const MachineParameter* const known = FindParameter(KindOf(machine), parameter);
  return known == nullptr ? Told(parameter)
                          : Tell("the fitted {} ({})", "{} ({}) im Fit", known->meaning, parameter);
}

/// The change may lie in the blocks at either side of the place found; these are left out where enough remain.
StoredChange ChangeAt(const BlockSeries& series, const LevelChange& change, const Machine& machine) {
  const std::size_t n = series.blocks.size();
  const std::size_t last_before = change.at > kFewestOfALevel ? change.at - 1 : change.at;
  const std::size_t first_after = n - change.at > kFewestOfALevel ? change.at + 1 : change.at;
  StoredChange found;
  found.before_end = series.blocks[last_before]->first;
  found.since = series.blocks[first_after]->first;
  found.by = series.parameter;
  found.text = Tell("between {} {} and {}, where {} changes its level",
                    "zwischen {} {} und {}, wo {} die Höhe wechselt", CountedWordsOf(machine).Many(),
                    found.before_end, found.since, FittedAs(machine, series.parameter));
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

/// The error over the blocks, and what it may go with instead: the oil and what the strokes were driven at.
struct ErrorSeries {
  BlockSeries series{kByModelError, {}, {}, {}};
  std::vector<std::vector<double>> others = std::vector<std::vector<double>>(1 + kMaxConditions);
};

ErrorSeries ErrorsOver(const std::vector<BlockEstimates>& blocks) {
  ErrorSeries out;
  for (const BlockEstimates& block : blocks) {
    if (!std::isfinite(block.error)) continue;
    out.series.values.push_back(std::log(std::max(1 + block.error, kLeastEnergy)));
    out.series.blocks.push_back(&block);
    out.others.back().push_back(block.oil_temperature);
    for (std::size_t k = 0; k < block.conditions.size(); ++k) out.others[k].push_back(block.conditions[k]);
  }
  return out;
}

std::optional<StoredChange> ErrorGrows(const std::vector<BlockEstimates>& blocks, const HistoryPart& part,
                                       const Machine& machine) {
  const auto [series, others] = ErrorsOver(blocks);
  const auto growth = FindErrorGrowth(series.values, others);
  if (!growth) return std::nullopt;
  StoredChange found = ChangeAt(series, *growth, machine);
  found.text = Tell("between {} {} and {}, where the model begins to err more",
                    "zwischen {} {} und {}, wo das Modell mehr zu irren beginnt",
                    CountedWordsOf(machine).Many(), found.before_end, found.since);
  if (!LeavesEnough(found, part)) return std::nullopt;
  return found;
}

/// Whether strokes of `part` lie on both sides of a stretch.
bool LiesWithin(const StoredChange& stretch, const HistoryPart& part) {
  return stretch.before_end - part.first >= kFewestOnASide && part.last - stretch.since >= kFewestOnASide;
}

/// Which parameter tells of it is no matter: on both sides the machine is as it was.
StoredChange StretchAt(const BlockSeries& series, const Stretched& stretch, const CountedWords& counted) {
  StoredChange found;
  found.before_end = series.blocks[stretch.first]->first;
  found.since = series.blocks[stretch.last]->first;
  found.by = series.parameter;
  found.passes = true;
  const Told where = series.parameter == kByModelError
                         ? Told(", where the model errs more", ", wo das Modell mehr irrt")
                         : Told();
  found.text = Tell("from {} {} to {}{}", "von {} {} bis {}{}", counted.One(), found.before_end,
                    found.since - 1, where);
  return found;
}

Result<std::vector<BlockEstimates>> BlocksOf(const Database& database, const HistoryPart& part,
                                             const Machine& machine) {
  const auto strokes = TRY(database.SummariesOf(part.id, part.first, part.last, kOilSample));
  return EstimateBlocks(database, part.id, machine, strokes);
}

std::optional<StoredChange> EvidentInBlocks(const Database& database, const HistoryPart& part,
                                            const Machine& machine) {
  const auto blocks = BlocksOf(database, part, machine);
  if (!blocks) return std::nullopt;
  std::optional<StoredChange> clearest;
  double p = kEvident;
  for (const BlockSeries& series : SeriesOfParameters(*blocks)) {
    const auto change = FindLevelChange(series.values, {series.oil});
    if (!change || !(change->p < p)) continue;
    StoredChange found = ChangeAt(series, *change, machine);
    if (!LeavesEnough(found, part)) continue;
    p = change->p;
    clearest = std::move(found);
  }
  if (clearest) return clearest;
  return ErrorGrows(*blocks, part, machine);
}

/// The stretch that a parameter, or else the error, shows most evidently.
std::optional<StoredChange> StretchInBlocks(const Database& database, const HistoryPart& part,
                                            const Machine& machine) {
  const auto blocks = BlocksOf(database, part, machine);
  if (!blocks) return std::nullopt;
  const CountedWords counted = CountedWordsOf(machine);
  std::optional<StoredChange> clearest;
  double p = kEvident;
  const auto look = [&](const BlockSeries& series, const std::optional<Stretched>& stretch) {
    if (!stretch || !(stretch->p < p)) return;
    StoredChange found = StretchAt(series, *stretch, counted);
    if (!LiesWithin(found, part)) return;
    p = stretch->p;
    clearest = std::move(found);
  };
  for (const BlockSeries& series : SeriesOfParameters(*blocks))
    look(series, FindStretch(series.values, {series.oil}));
  if (clearest) return clearest;
  const auto [series, others] = ErrorsOver(*blocks);
  const auto stretch = FindStretch(series.values, others);
  if (stretch && stretch->inside - stretch->outside > std::log(1 + kFloorExcess)) look(series, stretch);
  return clearest;
}

void AddChangesOf(const Database& database, const HistoryPart& part, const Machine& machine,
                  const std::vector<AlarmState>& alarms, std::vector<StoredChange>& changes) {
  if (changes.size() >= kMostChanges) return;
  const auto change = FindStoredChange(database, part, machine, alarms);
  if (!change) {
    if (auto stretch = StretchInBlocks(database, part, machine)) changes.push_back(std::move(*stretch));
    return;
  }
  changes.push_back(*change);
  AddChangesOf(database, {part.machine, part.id, part.first, change->before_end}, machine, alarms, changes);
  AddChangesOf(database, {part.machine, part.id, change->since, part.last}, machine, alarms, changes);
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
  auto [best, least, places] = FindBestPlace(values);
  std::vector<double> numbers(n);
  std::iota(numbers.begin(), numbers.end(), 0.0);
  const double line = std::min(SquaresAboutLine(numbers, values), SquaresAboutLines(others, values));
  if (!(least <= kBetterThanALine * line)) return std::nullopt;
  best.p = ChanceOf({best, least, places}, n);
  if (!(best.p < kEvident)) return std::nullopt;
  return best;
}

std::optional<BothEnds> FindWhatMovesOn(const std::vector<double>& values,
                                        const std::vector<std::vector<double>>& others) {
  const std::size_t n = values.size();
  if (n < kFewestValues) return std::nullopt;
  const BestPlace best = FindBestPlace(values);
  std::vector<double> numbers(n);
  std::iota(numbers.begin(), numbers.end(), 0.0);
  const double least = std::min(best.squares, SquaresAboutLine(numbers, values));
  if (!(least <= kBetterThanALine * SquaresAboutLines(others, values))) return std::nullopt;
  const double p = ChanceOf(best, n);
  if (!(p < kEvident)) return std::nullopt;
  return BothEnds{CountAlike(values), n - CountAlike({values.rbegin(), values.rend()}), p};
}

std::optional<Stretched> FindStretch(const std::vector<double>& values,
                                     const std::vector<std::vector<double>>& others) {
  const std::size_t n = values.size();
  if (n < 3 * kFewestOfALevel) return std::nullopt;
  const double mean = MeanOf(values.data(), values.data() + n),
               all = SquaresAboutMean(values.data(), values.data() + n);
  double best = 0, places = 0;  // squares that the stretch explains
  Stretched found;
  for (std::size_t first = kFewestOfALevel; first + 2 * kFewestOfALevel <= n; ++first) {
    double sum = 0;
    for (std::size_t last = first + 1; last + kFewestOfALevel <= n; ++last) {
      sum += values[last - 1] - mean;
      if (last - first < kFewestOfALevel) continue;
      ++places;
      const auto inside = static_cast<double>(last - first), outside = static_cast<double>(n) - inside;
      const double explained = sum * sum * (1 / inside + 1 / outside);
      if (explained <= best) continue;
      best = explained;
      found = {first, last, mean + sum / inside, mean - sum / outside, 1};
    }
  }
  std::vector<double> numbers(n);
  std::iota(numbers.begin(), numbers.end(), 0.0);
  const double left = std::max(0.0, all - best),
               line = std::min(SquaresAboutLine(numbers, values), SquaresAboutLines(others, values));
  if (!(left <= kBetterThanALine * line)) return std::nullopt;
  const double degrees = static_cast<double>(n) - 2;
  const double t = std::sqrt(best * degrees / std::max(left, 1e-300));
  found.p = std::min(1.0, places * StudentTwoSided(t, degrees));
  if (!(found.p < kEvident)) return std::nullopt;
  return found;
}

std::optional<LevelChange> FindErrorGrowth(const std::vector<double>& errors,
                                           const std::vector<std::vector<double>>& others) {
  const std::size_t n = errors.size();
  if (n < kFewestValues) return std::nullopt;
  auto [best, least, places] = FindBestPlace(errors);
  if (!(best.after - best.before > std::log(1 + kFloorExcess))) return std::nullopt;
  if (!(least <= kBetterThanALine * SquaresAboutLines(others, errors))) return std::nullopt;
  std::vector<double> after(n, 0.0);
  std::fill(after.begin() + static_cast<std::ptrdiff_t>(best.at), after.end(), 1.0);
  const CorrelatedFit fit = FitCorrelated({std::vector<double>(n, 1.0), after}, errors, {}, 0);
  if (fit.coefficients.empty()) return std::nullopt;
  best.p = std::min(1.0, places * fit.coefficients[1].p);
  if (!(best.p < kEvident)) return std::nullopt;
  while (best.at > kFewestOfALevel + 1 && StandsOut(errors.data(), errors.data() + best.at - 1)) --best.at;
  return best;
}

std::optional<StoredChange> FindStoredChange(const Database& database, const HistoryPart& part,
                                             const Machine& machine, const std::vector<AlarmState>& alarms) {
  if (auto told = ToldByAlarm(part, alarms, CountedWordsOf(machine))) return told;
  return EvidentInBlocks(database, part, machine);
}

std::optional<StoredChange> FindMovingOn(const Database& database, const HistoryPart& part,
                                         const Machine& machine) {
  const auto blocks = BlocksOf(database, part, machine);
  if (!blocks) return std::nullopt;
  const CountedWords counted = CountedWordsOf(machine);
  std::optional<StoredChange> clearest;
  double p = kEvident;
  for (const BlockSeries& series : SeriesOfParameters(*blocks)) {
    const auto ends = FindWhatMovesOn(series.values, {series.oil});
    if (!ends || !(ends->p < p)) continue;
    StoredChange found;
    found.before_end = series.blocks[ends->first_end]->first;
    found.since = series.blocks[ends->last_begin]->first;
    found.by = series.parameter;
    found.text = Tell("between {} {} and {}, over which {} moves on",
                      "zwischen {} {} und {}, in der sich {} weiterbewegt", counted.Many(), found.before_end,
                      found.since, series.parameter);
    if (!LeavesEnough(found, part)) continue;
    p = ends->p;
    clearest = std::move(found);
  }
  return clearest;
}

std::vector<StoredChange> FindStoredChanges(const Database& database, const HistoryPart& part,
                                            const Machine& machine, const std::vector<AlarmState>& alarms) {
  std::vector<StoredChange> changes;
  AddChangesOf(database, part, machine, alarms, changes);
  std::ranges::sort(changes, {}, &StoredChange::since);
  if (changes.empty())
    if (auto moving = FindMovingOn(database, part, machine)) changes.push_back(std::move(*moving));
  return changes;
}

std::optional<RunInfo> LogThatBegins(const Database& database, const HistoryPart& part,
                                     const StoredChange& change) {
  const auto runs = database.Runs(part.id);
  if (!runs) return std::nullopt;
  const auto begins = std::ranges::find_if(*runs, [&](const RunInfo& run) {
    return run.strokes > 0 && run.first_sequence > part.first && run.first_sequence >= change.before_end &&
           run.first_sequence <= change.since && run.source != kLiveSource;
  });
  return begins == runs->end() ? std::nullopt : std::optional(*begins);
}

Told AnotherMachineText(const RunInfo& log, const CountedWords& counted) {
  return Tell(
      "The log {} begins there, with {} {}: if it is of another machine, replay it into a database of its own",
      "Das Log {} beginnt dort, mit {} {}: ist es von einer anderen Maschine, gehört es in eine eigene Datenbank",
      log.source, counted.One(), log.first_sequence);
}

Told WarningOfBothSides(const StoredChange& change, const CountedWords& counted) {
  if (change.passes)
    return Tell(
        "these {} hold a stretch that differs from those on both sides of it, {}: one model for all of them errs; look at "
        "it with --from {} --to {}",
        "in diesen {} liegt eine Strecke, die sich von denen auf ihren beiden Seiten unterscheidet, {}: ein Modell für alle "
        "irrt; sie für sich zeigt --from {} --to {}",
        counted.SeveralDative(), change.text, change.before_end, change.since);
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
