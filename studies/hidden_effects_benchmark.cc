#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iostream>
#include <map>
#include <random>
#include <vector>

#include "core/contains.h"
#include "diagnosis/effect_ranking.h"
#include "diagnosis/experiment/experiment.h"
#include "diagnosis/explain.h"
#include "diagnosis/remainder/locate.h"
#include "diagnosis/remainder/whiteness.h"
#include "host/output.h"
#include "studies/benchmarks.h"
#include "studies/random_effect.h"
#include "studies/simulated_strokes.h"

namespace hydroscope {
namespace {

enum Kind {
  kOne,
  kWeak,
  kTooWeak,
  kTwo,
  kTwoOneWeak,
  kOutside,
  kOutsideWeak,
  kHealthy,
  kConstantSpeed,
  kKinds
};
constexpr std::array<const char*, kKinds> kKindNames = {"one effect, error +10 % or more",
                                                        "one weak effect, 2 ... 10 %",
                                                        "one effect, below 2 %",
                                                        "two effects at once",
                                                        "two effects, one below 2 %",
                                                        "effect outside the library",
                                                        "outside the library, below 2 %",
                                                        "healthy",
                                                        "constant ram speed"};
constexpr double kAtFloor = 0.05;  ///< held-out error over the noise floor with the right effect in the model
/// What a simulated machine may do in an experiment beside what it does anyway, Pa.
constexpr double kLowestRod = 20e5, kHighestRod = 100e5;
/// Pa, standard error of a gauge and of a sensor's reading; s, over which it is taken.
constexpr double kGaugeError = 0.1e5, kReadingTime = 2;
constexpr double kFilterError = 1e-4;  ///< s, standard error of a filter's time constant

struct Case {
  Kind kind = kHealthy;
  int number = 0;  ///< in the campaign
  PressOptions options;
  std::vector<std::string> truth;
  /// Relative rise of the held-out error over that of the true model; of two effects the weaker one.
  double excess = 0;
  Explanation explanation;
  Experiment experiment;                    ///< proposed if ambiguous
  bool located = false, patterned = false;  ///< healthy: an error is located, what is left is not white
  Explanation after;                        ///< of both logs, once it is recorded
  bool proposed = false;                    ///< a series of strokes or a test off the log
  bool by_strokes = false;                  ///< the strokes alone name the truth alone
  bool resolved = false;                    ///< the truth is then named alone
};

struct KindTally {
  int cases = 0, first = 0, in_set = 0, all_found = 0, wrong = 0, adequate = 0, unknown = 0, partial = 0,
      sets = 0;
  int right_alone = 0, at_floor = 0;  ///< the one true effect named; its error within kAtFloor of the floor
  int located = 0, patterned = 0;
  int ambiguous = 0, proposed = 0, by_strokes = 0, resolved = 0,
      settled = 0;      ///< ambiguous with the truth in the set
  double set_size = 0;  ///< names, of effects that no stroke tells apart one
};

Case Draw(int index, std::uint64_t seed, bool healthy) {
  std::mt19937_64 random(seed * 1000003 + index);
  Case c;
  c.options = RandomMachine(random() >> 32);
  c.options.seconds = 60 + 120 * Uniform(random);
  c.options.oil_start = 298 + 10 * Uniform(random);
  c.options.oil_end = c.options.oil_start + 5 + 20 * Uniform(random);
  switch (index % 8) {
    case 0:
    case 1:
    case 2:
    case 3:
      c.kind = kOne;
      c.options.effects = {RandomEffect(random, 0.1, 2.0, false)};
      break;
    case 4:
      c.kind = kTwo;
      c.options.effects = {RandomEffect(random, 0.5, 2.0, true), RandomEffect(random, 0.5, 2.0, true)};
      while (c.options.effects[1].id == c.options.effects[0].id)
        c.options.effects[1] = RandomEffect(random, 0.5, 2.0, true);
      break;
    case 5:
      c.kind = kOutside;
      c.options.effects = {RandomEffect(random, 0.5, 2.0, true)};
      break;
    case 6:
      c.kind = kHealthy;
      break;
    default:
      c.kind = kConstantSpeed;
      c.options.effects = {RandomEffect(random, 0.3, 2.0, false)};
      c.options.motion.speed_min = c.options.motion.speed_max = 0.03 + 0.05 * Uniform(random);
  }
  if (healthy) {
    c.kind = kHealthy;
    c.options.effects.clear();
  }
  for (const EffectSetting& e : c.options.effects) c.truth.push_back(e.id);
  return c;
}

Result<LogStrokes> StrokesFor(const PressOptions& options) {
  return StrokesOf(SimulatePress(options), MachineFor(options), KeepSamples::kYes);
}

/// Sorts cases by how much the effect matters; of two effects the one that matters less on its own.
void Grade(Case& c) {
  c.excess = ErrorOverFloor(c.explanation.base);
  if (c.kind == kOutside && c.excess < kNoticedError) c.kind = kOutsideWeak;
  if (c.kind == kOne) c.kind = c.excess >= kStrongError ? kOne : c.excess >= kNoticedError ? kWeak : kTooWeak;
  if (c.kind != kTwo) return;
  for (const EffectSetting& effect : c.options.effects) {
    PressOptions alone = c.options;
    alone.effects = {effect};
    if (const auto strokes = StrokesFor(alone)) {
      const StrokeSet set(strokes->model, strokes->Grams(), strokes->window);
      c.excess = std::min(c.excess, ErrorOverFloor(set.Fit({})));
    }
  }
  if (c.excess < kNoticedError) c.kind = kTwoOneWeak;
}

/// One true effect, and else its twins only.
bool IsTruthWithTwins(const ModelStructure& model, const std::vector<std::string>& group,
                      const std::vector<std::string>& truth) {
  for (const std::string& id : truth) {
    if (!Contains(group, id)) continue;
    const std::vector<std::string> twins = TwinsOf(model, id);
    return std::ranges::all_of(
        group, [&](const std::string& other) { return other == id || Contains(twins, other); });
  }
  return false;
}

/// As far as strokes can: every true effect alone or beside its twins.
bool IsSettled(const Explanation& x, const std::vector<std::string>& truth) {
  return x.groups.size() == truth.size() && std::ranges::all_of(x.groups, [&](const auto& group) {
           return IsTruthWithTwins(*x.model, group, truth);
         });
}

/// The log of the proposed series of strokes, on the same machine.
Result<LogStrokes> RecordExperiment(const Case& c) {
  PressOptions options = c.options;
  PressMotion& motion = options.motion;
  motion.speeds = c.experiment.Levels("ram_speed");
  motion.set_points = c.experiment.Levels("pressure");
  motion.rod_pressures = c.experiment.Levels("rod_pressure");
  motion.speed_max = std::max(motion.speed_max, *std::ranges::max_element(motion.speeds));
  double cycle = 0;
  for (double speed : motion.speeds)
    cycle += (motion.z_top - motion.z_bottom) * (1 / speed + 1 / motion.return_speed) + 2 * motion.ramp_time +
             motion.dwell_min + motion.dwell_max;
  options.seconds = c.experiment.strokes * cycle / static_cast<double>(motion.speeds.size()) + 5;
  for (const double warmer : c.experiment.Levels("warm_up")) options.oil_end = options.oil_start + warmer;
  options.seed += 1;
  return StrokesFor(options);
}

/// s, of the filter that the simulated signal passes: the simulated press has none but as an imperfection.
double FilterOf(const PressOptions& options, const std::string& id) {
  const auto filter =
      std::ranges::find_if(options.imperfections, [&](const ImperfectionSetting& i) { return i.kind == id; });
  return filter == options.imperfections.end() ? 0.0 : filter->size;
}

/// What the tests off the log say of rivals that `open` leaves.
std::map<std::string, MeasuredSize> MeasureOffTheLog(const Case& c, const Explanation& open) {
  std::map<std::string, MeasuredSize> measured;
  for (const std::string& id : open.set) {
    if (id == "pressure_offset") measured[id] = {VentedReading(c.options, kReadingTime), kGaugeError};
    if (id == "tank_pressure")
      measured[id] = {TankLinePressure(c.options) - c.options.machine.p_tank, kGaugeError};
    if (id.ends_with("_signal_lag")) measured[id] = {FilterOf(c.options, id), kFilterError};
  }
  return measured;
}

bool IsNamedAlone(const Explanation& x, const std::vector<std::string>& truth) {
  return x.verdict == Verdict::kNamed && x.set.size() == truth.size() &&
         std::is_permutation(x.set.begin(), x.set.end(), truth.begin());
}

/// Does what is proposed, on the same machine: strokes first, explained together with the log, then the tests off the log if
/// these leave anything open.
void RunExperiment(const LogStrokes& first, ExplainOptions explain, Case& c) {
  if (c.explanation.verdict != Verdict::kAmbiguous) return;
  LogStrokes both = first;
  c.proposed = c.experiment.proposed();
  if (c.proposed) {
    auto second = RecordExperiment(c);
    if (!second) return;
    Append(std::move(*second), both);
    c.after = ExplainSamples(first.model, both.stretches, first.window, explain);
    c.by_strokes = c.resolved = IsNamedAlone(c.after, c.truth);
  }
  explain.measured = MeasureOffTheLog(c, c.after.base.solved ? c.after : c.explanation);
  if (c.resolved || explain.measured.empty()) return;
  c.proposed = true;
  c.after = ExplainSamples(first.model, both.stretches, first.window, explain);
  c.resolved = IsNamedAlone(c.after, c.truth);
}

/// What the machine may do in an experiment: what a random machine does, with the oil warming.
Machine MachineToAsk(const Case& c, Machine machine) {
  const PressMotion usual = RandomMachine(c.options.seed).motion;
  machine.experiment = {
      .settings = {{"ram_speed", {usual.speed_min, usual.speed_max}},
                   {"pressure", {std::min(usual.set_point_min, usual.rest_pressure), usual.set_point_max}},
                   {"rod_pressure", {kLowestRod, kHighestRod}},
                   {"warm_up", {{}, 20.0}}},
      .max_strokes = 400,
      .signals = {}};
  return machine;
}

/// What `compare` would say of a log without an error.
void LookForPatterns(const LogStrokes& strokes, Case& c) {
  constexpr double kPattern = 1e-4;
  const Explanation& x = c.explanation;
  const Residuals residuals =
      ResidualsOf(x.model, strokes.stretches, strokes.window, ColumnWeights(*x.model, x.base));
  c.located = !Locate(residuals).located.empty();
  c.patterned = WhitenessOf(residuals).p_value < kPattern;
}

void Count(const Case& c, KindTally& t) {
  const Explanation& x = c.explanation;
  const bool named = x.verdict == Verdict::kNamed || x.verdict == Verdict::kAmbiguous;
  const auto found = [&](const std::string& id) { return Contains(x.set, id); };
  ++t.cases;
  t.adequate += x.verdict == Verdict::kAdequate;
  t.unknown += x.verdict == Verdict::kUnknown;
  t.located += c.located;
  t.patterned += c.patterned;
  if (!named) return;
  t.partial += x.partial;
  ++t.sets;
  for (const auto& group : x.groups) t.set_size += static_cast<double>(ClassesOf(x, group).size());
  const bool any = std::ranges::any_of(c.truth, found);
  const bool all = !c.truth.empty() && std::ranges::all_of(c.truth, found);
  t.first += !c.truth.empty() && Contains(c.truth, x.set.front());
  t.in_set += any;
  t.all_found += all;
  // What is not in the library cannot be in the set: there a set is wrong unless it says that it is partial.
  const bool outside = c.kind == kOutside || c.kind == kOutsideWeak;
  t.wrong += !any && !(outside && x.partial);
  if (x.set == c.truth) {
    ++t.right_alone;
    t.at_floor += x.final.rms_holdout <= (1 + kAtFloor) * x.final.noise_floor;
  }
  if (x.verdict == Verdict::kAmbiguous && all) {
    ++t.ambiguous;
    t.proposed += c.proposed || c.experiment.proposed();
    t.by_strokes += c.by_strokes;
    t.resolved += c.resolved;
    t.settled += IsSettled(c.after.base.solved ? c.after : x, c.truth);
  }
}

void PrintConfusion(const std::vector<Case>& cases) {
  std::map<std::string, std::map<std::string, int>> confusion;
  for (const Case& c : cases) {
    if (c.kind != kOne && c.kind != kWeak) continue;
    const Explanation& x = c.explanation;
    ++confusion[c.truth.front()][x.set.empty() ? VerdictName(x.verdict) : x.set.front()];
  }
  std::cout << "\nsingle effects of +2 % or more: hidden -> first answer\n";
  for (const auto& [truth, answers] : confusion) {
    fmt::print("  {:<28}", truth);
    for (const auto& [answer, count] : answers)
      fmt::print(" {} x{}", answer == truth ? "found" : answer, count);
    std::cout << "\n";
  }
}

std::string Top(const std::vector<RankedEffect>& ranking, std::size_t count) {
  std::string text;
  for (std::size_t k = 0; k < std::min(count, ranking.size()); ++k) {
    if (!ranking[k].fit.solved) continue;
    const EffectEstimate& e = ranking[k].fit.effects.back();
    text += fmt::format("{} {:.0f}/{:.1f} ", ranking[k].id, ranking[k].gain, e.size / e.std);
  }
  return text;
}

/// What came out of the experiment, if it was run.
std::string AfterText(const Case& c) {
  const Explanation& x = c.after;
  if (!x.base.solved) return "";
  return fmt::format(" -> separation {:.0f} -> {} {} | {} | {}", c.experiment.separation,
                     VerdictName(x.verdict), fmt::join(x.set, " "), Top(x.ranking, 3), Top(x.second, 3));
}

void WriteDetails(const std::string& path, const std::vector<Case>& cases) {
  std::ofstream file(path);
  file << "kind\ttruth=size\texcess\tbase_excess\tfinal_excess\tverdict\tset\tbest gain/t\tsecond "
          "gain/t\tpartial"
          "\tfit_excess\tstrokes\tremainder\tlaw\tmargin\tlaw\tnonlinear\tcase\tmodel_excess\texperiment\n";
  for (const Case& c : cases) {
    const Explanation& x = c.explanation;
    std::string truth, set;
    for (std::size_t k = 0; k < c.truth.size(); ++k)
      truth += fmt::format("{}={:.3g} ", c.truth[k], c.options.effects[k].size);
    for (const std::string& id : x.set) set += id + " ";
    std::string nonlinear;
    for (const EffectChoice& choice : x.chosen)
      nonlinear += fmt::format("{:.4g} ",
                               fmt::join(x.model->effect_shapes[choice.effect][choice.shape].nonlinear, ","));
    file << fmt::format(
        "{}\t{}\t{:.3f}\t{:.3f}\t{:.3f}\t{}\t{}\t{}\t{}\t{}\t{:.3f}\t{}\t{:.0f}\t{}\t{:.0f}\t{}\t{}\t{}\t{:.3f}\t{}\n",
        kKindNames[c.kind], truth, c.excess, x.base.excess_ratio, x.final.excess_ratio,
        VerdictName(x.verdict), set, Top(x.ranking, 5), Top(x.second, 3), x.partial ? "partial" : "",
        x.final.fit_excess_ratio, x.final.excess.size(), x.remainder, x.remainder_law, x.margin, x.margin_law,
        nonlinear, c.number, ErrorOverFloor(x.final),
        (c.experiment.proposed() ? ExperimentText(c.experiment).english : "-") + AfterText(c));
  }
}

double Percent(int part, int whole) { return whole > 0 ? 100.0 * part / whole : 0.0; }

void PrintTable(const std::array<KindTally, kKinds>& tallies) {
  fmt::print("{:<34}{:>6}{:>9}{:>9}{:>9}{:>8}{:>10}{:>10}{:>9}{:>10}\n", "", "cases", "first", "in set",
             "all", "wrong", "adequate", "unknown", "partial", "set size");
  for (int k = 0; k < kKinds; ++k) {
    const KindTally& t = tallies[k];
    fmt::print("{:<34}{:>6}{:>7.1f} %{:>7.1f} %{:>7.1f} %{:>6.1f} %{:>8.1f} %{:>8.1f} %{:>7.1f} %{:>10.2f}\n",
               kKindNames[k], t.cases, Percent(t.first, t.cases), Percent(t.in_set, t.cases),
               Percent(t.all_found, t.cases), Percent(t.wrong, t.cases), Percent(t.adequate, t.cases),
               Percent(t.unknown, t.cases), Percent(t.partial, t.cases),
               t.sets > 0 ? t.set_size / t.sets : 0.0);
  }
}

/// Sums over the classes in which the true effect is in the library.
KindTally Known(const std::array<KindTally, kKinds>& tallies) {
  KindTally sum;
  for (int k : {kOne, kWeak, kTooWeak, kTwo, kTwoOneWeak, kConstantSpeed}) {
    sum.right_alone += tallies[k].right_alone;
    sum.at_floor += tallies[k].at_floor;
    sum.ambiguous += tallies[k].ambiguous;
    sum.proposed += tallies[k].proposed;
    sum.by_strokes += tallies[k].by_strokes;
    sum.resolved += tallies[k].resolved;
    sum.settled += tallies[k].settled;
  }
  return sum;
}

/// What is required of a figure.
struct Goal {
  const char* what;
  double value;
  bool at_least;
  double limit;

  bool reached() const { return at_least ? value >= limit : value <= limit; }
};

/// Of the kinds that occur.
std::vector<Goal> Goals(const std::array<KindTally, kKinds>& t, bool experiments) {
  constexpr bool kAtLeast = true, kAtMost = false;
  std::vector<Goal> goals;
  const auto require = [&](const char* what, int count, int of, bool at_least, double limit) {
    if (of > 0) goals.push_back({what, Percent(count, of), at_least, limit});
  };
  const auto names_in_a_set = [&](const char* what, const KindTally& k, double limit) {
    if (k.sets > 0) goals.push_back({what, k.set_size / k.sets, kAtMost, limit});
  };
  const KindTally &one = t[kOne], &weak = t[kWeak], &two = t[kTwo], &outside = t[kOutside],
                  &healthy = t[kHealthy], &constant = t[kConstantSpeed], known = Known(t);
  require("one effect, named first, %", one.first, one.cases, kAtLeast, 95);
  require("one effect, in the set, %", one.in_set, one.cases, kAtLeast, 99);
  require("one effect, wrong, %", one.wrong, one.cases, kAtMost, 1);
  names_in_a_set("one effect, names in a set", one, 1.5);
  require("weak effect, in the set or adequate, %", weak.in_set + weak.adequate, weak.cases, kAtLeast, 80);
  require("weak effect, wrong, %", weak.wrong, weak.cases, kAtMost, 2);
  names_in_a_set("weak effect, names in a set", weak, 2.5);
  require("two effects, both found, %", two.all_found, two.cases, kAtLeast, 85);
  require("two effects, wrong, %", two.wrong, two.cases, kAtMost, 3);
  require("outside the library, unknown or partial, %", outside.unknown + outside.partial, outside.cases,
          kAtLeast, 95);
  require("outside the library, wrong, %", outside.wrong, outside.cases, kAtMost, 2);
  require("healthy, adequate, %", healthy.adequate, healthy.cases, kAtLeast, 99);
  require("constant ram speed, wrong, %", constant.wrong, constant.cases, kAtMost, 1);
  if (experiments)
    require("ambiguous, settled by what was proposed, %", known.settled, known.ambiguous, kAtLeast, 90);
  return goals;
}

/// Prints which goals are not reached. Whether all are.
bool PrintGoals(const std::vector<Goal>& goals) {
  bool all = true;
  for (const Goal& goal : goals) {
    if (goal.reached()) continue;
    all = false;
    fmt::print("NOT reached: {} {:.4g}, required {} {:.4g}\n", goal.what, goal.value,
               goal.at_least ? "at least" : "at most", goal.limit);
  }
  if (all) fmt::print("all goals reached\n");
  return all;
}

}  // namespace

int RunHiddenEffectsBenchmark(const HiddenEffectsOptions& o) {
  std::vector<Case> all;
  ProgressBar progress("hidden effects", "logs");
  for (int i = 0; i < o.cases; ++i) {
    if (!o.only.empty() && !Contains(o.only, i)) continue;
    Case c = Draw(i, o.seed, o.healthy);
    c.number = i;
    const auto strokes = StrokesFor(c.options);
    if (!strokes) {
      ReportError(strokes.error());
      return 1;
    }
    ExplainOptions options;
    if (c.kind == kOutside) {
      options.exclude = c.truth;  // and what is the same law to the strokes
      for (const std::string& id : c.truth)
        for (const std::string& twin : TwinsOf(*strokes->model, id)) options.exclude.push_back(twin);
    }
    c.explanation = ExplainSamples(strokes->model, strokes->stretches, strokes->window, options);
    c.experiment = ProposeExperiment(c.explanation, MachineToAsk(c, strokes->machine), strokes->stretches,
                                     strokes->window);
    if (o.experiments) RunExperiment(*strokes, options, c);
    if (c.kind == kHealthy) LookForPatterns(*strokes, c);
    Grade(c);
    all.push_back(std::move(c));
    progress.Update((i + 1.0) / o.cases, i + 1);
  }
  std::array<KindTally, kKinds> tallies;
  for (const Case& c : all) Count(c, tallies[c.kind]);

  fmt::print("{} simulated logs of 60 ... 180 s, seed {}\n\n", o.cases, o.seed);
  PrintTable(tallies);
  PrintConfusion(all);
  const KindTally known = Known(tallies);
  fmt::print("\nright effect named alone: {} cases, {:.1f} % of them within 5 % of the noise floor\n",
             known.right_alone, Percent(known.at_floor, known.right_alone));
  const KindTally& healthy = tallies[kHealthy];
  fmt::print(
      "healthy: {} cases, an error located in {} ({:.1f} %), a pattern in time claimed in {} ({:.1f} %)\n",
      healthy.cases, healthy.located, Percent(healthy.located, healthy.cases), healthy.patterned,
      Percent(healthy.patterned, healthy.cases));
  fmt::print("ambiguous with the truth in the set: {} cases, experiment proposed for {}", known.ambiguous,
             known.proposed);
  std::cout << (o.experiments
                    ? fmt::format(
                          "\nnamed alone after the strokes proposed {} ({:.1f} %), and after the tests off "
                          "the log proposed {} ({:.1f} %); alone or beside its twins {} ({:.1f} %)\n",
                          known.by_strokes, Percent(known.by_strokes, known.ambiguous), known.resolved,
                          Percent(known.resolved, known.ambiguous), known.settled,
                          Percent(known.settled, known.ambiguous))
                    : "\n");
  if (!o.details.empty()) WriteDetails(o.details, all);
  fmt::print("\n");
  return PrintGoals(Goals(tallies, o.experiments)) ? 0 : 1;
}

}  // namespace hydroscope
