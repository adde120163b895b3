#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "core/constants.h"
#include "estimation/gram_fit.h"
#include "host/output.h"
#include "storage/database.h"
#include "studies/drift/drift_benchmarks.h"
#include "studies/simulated_replay.h"
#include "workbench/history/trend_analysis.h"

namespace hydroscope {
namespace {

struct Watched {
  const char* name;
  const char* parameter;
  int estimate;   ///< index in StrokeRecord::estimates
  double factor;  ///< SI to the unit shown
  const char* unit;
  bool follows;  ///< should follow the oil
};
constexpr std::array<Watched, 3> kWatched = {{{"Q_vn", "Q_vn", 2, 6e4, "l/min", true},
                                              {"K'", "K", 0, 1e-9, "GPa", false},
                                              {"V0", "V0", 1, 1e3, "l", false}}};
using Values = std::array<double, 3>;  ///< of kWatched, in shown units

/// What was known of one run.
struct RunResult {
  double oil = 0;         ///< K, mean over the strokes
  double gated_time = 0;  ///< s that entered the equations
  std::int64_t strokes = 0;
  Values value, std;  ///< fitted to this run by itself
  Values trend;       ///< of the recursive estimator after the run ...
  Values trend_oil;   ///< ... and the oil temperature it stands for, K
};

struct Slopes {
  std::array<TestedValue, 3> by_itself, trend;  ///< shown units per K
  std::array<OilOutcome, 3> report;
  std::array<bool, 3> changed{};  ///< the report: clearly, and the oil does not account for it
  double memory = 0;              ///< correlation of successive trend values
};

PressOptions RunOptions(const ThirtyRunsOptions& o, std::uint64_t seed, int run) {
  PressOptions press;
  press.seconds = o.seconds;
  press.seed = seed * 1000 + run;
  const double step = (o.oil_last - o.oil_first) / o.runs;
  press.oil_start = o.oil_first + step * run + kZeroCelsius;
  press.oil_end = press.oil_start + step;
  press.effects = {{"oil_viscosity", o.viscosity, {}}};
  return press;
}

/// Logs of one seed, replayed.
Result<ReplayOutcome> Replay(const ThirtyRunsOptions& o, std::uint64_t seed, const WorkFolder& folder,
                             const std::string& database, const std::string& report) {
  std::vector<PressOptions> runs;
  for (int run = 0; run < o.runs; ++run) runs.push_back(RunOptions(o, seed, run));
  return ReplaySimulated(runs, folder, database, report);
}

/// What the database holds of one run; `trends` are those of the machine in order.
Result<RunResult> RunFrom(const Database& database, std::int64_t machine_id, const RunInfo& run,
                          const ReplayOutcome& outcome, const std::vector<TrendPoint>& trends) {
  const double period = RunOptions({}, 1, 0).sample_period;
  const auto strokes = TRY(database.Strokes(run.id));
  const auto grams = TRY(database.Grams(machine_id, run.first_sequence, run.first_sequence + run.strokes));
  const auto model = TRY(BuildModel(outcome.machine));
  const auto fit = TRY(FitBaseModel(*model, grams, WindowSamples::From(outcome.machine.window, period)));
  RunResult result;
  result.strokes = run.strokes;
  for (const StrokeSummary& stroke : strokes) {
    result.oil += stroke.oil_temperature / static_cast<double>(run.strokes);
    result.gated_time += static_cast<double>(stroke.counters.used) * period;
  }
  for (std::size_t w = 0; w < kWatched.size(); ++w) {
    const Estimate& own = fit.parameters[kWatched[w].estimate];
    result.value[w] = own.value * kWatched[w].factor;
    result.std[w] = own.std * kWatched[w].factor;
    for (const TrendPoint& point : trends)
      if (point.run == run.id && point.estimate.parameter == kWatched[w].parameter) {
        result.trend[w] = point.estimate.value * kWatched[w].factor;
        result.trend_oil[w] = point.estimate.oil_temperature;
      }
  }
  return result;
}

/// Slope of `value` over `oil`, per K; the temperature is centred, which keeps the regression well conditioned.
TestedValue SlopeOf(const std::vector<double>& oil, const std::vector<double>& value,
                    double least_correlation) {
  std::vector<double> ones(oil.size(), 1.0), centred = oil, std(oil.size(), 0.0);
  double mean = 0;
  for (double t : oil) mean += t / static_cast<double>(oil.size());
  for (double& t : centred) t -= mean;
  const CorrelatedFit fit = FitCorrelated({ones, centred}, value, std, least_correlation);
  return fit.coefficients.empty() ? TestedValue() : fit.coefficients[1];
}

Slopes SlopesOf(const std::vector<RunResult>& runs, const Machine& machine, const TrendAnalysis& report) {
  Slopes slopes;
  double gated_time = 0;
  for (const RunResult& run : runs) gated_time += run.gated_time / static_cast<double>(runs.size());
  slopes.memory = std::exp(-gated_time / machine.estimator.time_constant);
  for (std::size_t w = 0; w < kWatched.size(); ++w) {
    std::vector<double> oil, value, trend_oil, trend;
    for (const RunResult& run : runs) {
      oil.push_back(run.oil);
      value.push_back(run.value[w]);
      trend_oil.push_back(run.trend_oil[w]);
      trend.push_back(run.trend[w]);
    }
    slopes.by_itself[w] = SlopeOf(oil, value, 0);
    slopes.trend[w] = SlopeOf(trend_oil, trend, slopes.memory);
    for (const ParameterAnalysis& parameter : report.parameters)
      if (parameter.parameter == kWatched[w].parameter) {
        slopes.report[w] = parameter.oil.outcome;
        slopes.changed[w] = parameter.unexplained == Significance::kClear;
      }
  }
  return slopes;
}

struct Study {
  std::vector<RunResult> runs;
  Slopes slopes;
};

Result<Study> StudySeed(const ThirtyRunsOptions& o, std::uint64_t seed, const std::string& database_path,
                        const std::string& report_path) {
  const WorkFolder folder;
  const std::string path = database_path.empty() ? folder.File("runs.db") : database_path;
  const auto outcome = TRY(Replay(o, seed, folder, path, report_path));
  auto database = TRY(Database::OpenReadOnly(path));
  const auto machine_id = TRY(database.MachineId(outcome.machine.name));
  const auto trends = TRY(database.Trend(machine_id, ""));
  const auto strokes = TRY(database.SummariesOf(machine_id, 0, outcome.strokes, outcome.strokes));
  Study study;
  for (const RunInfo& run : outcome.runs) {
    auto result = TRY(RunFrom(database, machine_id, run, outcome, trends));
    study.runs.push_back(result);
  }
  ReportInput input;
  input.machine = outcome.machine;
  input.runs = outcome.runs;
  input.strokes = strokes;
  input.trends = trends;
  input.blocks = TRY(EstimateBlocks(database, machine_id, outcome.machine, strokes));
  study.slopes = SlopesOf(study.runs, outcome.machine, AnalyseTrends(input));
  return study;
}

void PrintRuns(const std::vector<RunResult>& runs) {
  fmt::print("{:>3} {:>7} {:>8}", "run", "oil °C", "strokes");
  for (const Watched& w : kWatched)
    fmt::print(" {:>12} ± std     {:>8}", fmt::format("{} {}", w.name, w.unit), "trend");
  std::cout << "\n";
  for (std::size_t i = 0; i < runs.size(); ++i) {
    fmt::print("{:>3} {:>7.2f} {:>8}", i + 1, runs[i].oil - kZeroCelsius, runs[i].strokes);
    for (std::size_t w = 0; w < kWatched.size(); ++w)
      fmt::print(" {:>12.4f} ± {:<7.4f} {:>8.4f}", runs[i].value[w], runs[i].std[w], runs[i].trend[w]);
    std::cout << "\n";
  }
}

double TrueSlope(const ThirtyRunsOptions& o, const Watched& w) {
  return w.follows ? o.viscosity * RunOptions(o, 1, 0).machine.Q_vn * w.factor : 0.0;
}

bool Holds(const TestedValue& slope, double value) {
  return std::abs(slope.value - value) <= slope.HalfWidth();
}

/// Interval holds the truth, and excludes 0 where the parameter follows the oil.
bool Right(const TestedValue& slope, double truth) {
  return Holds(slope, truth) && (truth == 0 || !Holds(slope, 0));
}

bool PrintSlopes(const char* title, const std::array<TestedValue, 3>& slopes, const ThirtyRunsOptions& o) {
  std::cout << "\n" << title << "\n";
  bool reached = true;
  for (std::size_t i = 0; i < kWatched.size(); ++i) {
    const Watched& w = kWatched[i];
    const double truth = TrueSlope(o, w);
    const bool right = Right(slopes[i], truth);
    reached = reached && right;
    fmt::print("{:<5} {:>9.4f} ± {:<8.4f} {}/K, truth {:.4f}: {} the truth, {} 0{}\n", w.name,
               slopes[i].value, slopes[i].HalfWidth(), w.unit, truth,
               Holds(slopes[i], truth) ? "holds" : "does NOT hold",
               Holds(slopes[i], 0) ? "holds" : "excludes", right ? "" : "  <- missed");
  }
  return reached;
}

const char* ReportWords(OilOutcome outcome) {
  switch (outcome) {
    case OilOutcome::kFollows:
      return "follows the oil";
    case OilOutcome::kHint:
      return "hint of a dependence";
    case OilOutcome::kNotSeen:
      return "no dependence seen";
    case OilOutcome::kNotInStep:
      return "moves, but not in step with the oil";
    default:
      return "cannot be told";
  }
}

bool SaidRight(const Slopes& slopes, std::size_t watched, const ThirtyRunsOptions& o) {
  const bool follows = o.viscosity != 0 && kWatched[watched].follows;
  return slopes.report[watched] == (follows ? OilOutcome::kFollows : OilOutcome::kNotSeen);
}

bool PrintReport(const Slopes& slopes, const ThirtyRunsOptions& o) {
  std::cout << "\nthe report says\n";
  bool reached = true;
  for (std::size_t i = 0; i < kWatched.size(); ++i) {
    const bool right = SaidRight(slopes, i, o);
    reached = reached && right;
    fmt::print("{:<5} {}{}\n", kWatched[i].name, ReportWords(slopes.report[i]), right ? "" : "  <- missed");
  }
  return reached;
}

bool Claims(const Slopes& slopes, std::size_t watched) {
  return slopes.report[watched] == OilOutcome::kFollows || slopes.report[watched] == OilOutcome::kNotInStep ||
         slopes.changed[watched];
}

/// What the reports of all seeds say. At most 5 % may claim anything of a parameter that does neither follow
/// the oil nor change; the one that follows must be found in all.
bool PrintReports(const std::vector<Slopes>& all, const ThirtyRunsOptions& o) {
  fmt::print("\nthe reports of {} seeds\n", all.size());
  int wrong = 0, found = 0, hints = 0;
  for (const Slopes& slopes : all) {
    bool claims = false, hint = false;
    for (std::size_t i = 0; i < kWatched.size(); ++i) {
      if (o.viscosity != 0 && kWatched[i].follows) {
        found += SaidRight(slopes, i, o);
        continue;
      }
      claims |= Claims(slopes, i);
      hint |= slopes.report[i] == OilOutcome::kHint;
    }
    wrong += claims;
    hints += hint && !claims;
  }
  const int seeds = static_cast<int>(all.size());
  if (o.viscosity != 0) fmt::print("Q_vn follows the oil in {} of {}\n", found, seeds);
  fmt::print(
      "said to follow the oil, to move or to have changed, though it does not: in {} of {} ({:.1f} "
      "%, at most 5 %), a hint in {}\n",
      wrong, seeds, 100.0 * wrong / seeds, hints);
  return 20 * wrong <= seeds && (o.viscosity == 0 || found == seeds);
}

void PrintSeeds(const std::vector<Slopes>& all, const ThirtyRunsOptions& o) {
  fmt::print("\nslopes over {} seeds; 95 % intervals that hold the truth, about 95 % are due\n{:<5}",
             all.size(), "seed");
  for (const Watched& w : kWatched)
    fmt::print(" {:>20} {:>20}", fmt::format("{} by itself", w.name), fmt::format("{} trend", w.name));
  std::cout << "\n";
  std::array<std::array<int, 2>, 3> held{};
  for (std::size_t s = 0; s < all.size(); ++s) {
    fmt::print("{:<5}", o.seed + s);
    for (std::size_t w = 0; w < kWatched.size(); ++w) {
      const std::array<TestedValue, 2> both = {all[s].by_itself[w], all[s].trend[w]};
      for (std::size_t k = 0; k < both.size(); ++k) {
        const bool holds = Holds(both[k], TrueSlope(o, kWatched[w]));
        held[w][k] += holds;
        fmt::print(" {:>9.4f} ± {:.4f} {}", both[k].value, both[k].HalfWidth(), holds ? " " : "!");
      }
    }
    std::cout << "\n";
  }
  fmt::print("{:<5}", "held");
  for (const auto& h : held)
    for (int count : h) fmt::print(" {:>20}", fmt::format("{} of {}", count, all.size()));
  std::cout << "\n";
}

}  // namespace

int RunThirtyRuns(const ThirtyRunsOptions& o) {
  if (!o.database.empty() && std::filesystem::exists(o.database))
    return ReportError(BadInput("{} exists already; the study needs a new database", o.database).value());
  fmt::print("{} consecutive runs of {:.0f} s, oil {} -> {} degC, flow gain {:+.2f} %/K, seed {}\n\n", o.runs,
             o.seconds, o.oil_first, o.oil_last, 100 * o.viscosity, o.seed);
  std::vector<Slopes> all;
  bool reached = true;
  for (int s = 0; s < o.seeds; ++s) {
    const bool first = s == 0;
    auto study = StudySeed(o, o.seed + s, first ? o.database : "", first ? o.report : "");
    if (!study) return ReportError(study.error());
    all.push_back(study->slopes);
    if (!first) continue;
    PrintRuns(study->runs);
    reached = PrintSlopes("slope over the oil temperature, each run fitted by itself, 95 % interval",
                          study->slopes.by_itself, o);
    const std::string title = fmt::format(
        "slope of the recorded trend over the oil temperature it stands for (successive "
        "runs correlated by {:.2f} or more)",
        study->slopes.memory);
    reached = PrintSlopes(title.c_str(), study->slopes.trend, o) && reached;
    reached = PrintReport(study->slopes, o) && reached;
  }
  if (o.seeds > 1) {
    PrintSeeds(all, o);
    reached = PrintReports(all, o) && reached;
  }
  std::cout << (reached ? "\nreached" : "\nNOT reached")
            << ": Q_vn follows the oil temperature, K' and V0 do not\n";
  return reached ? 0 : 1;
}

}  // namespace hydroscope
