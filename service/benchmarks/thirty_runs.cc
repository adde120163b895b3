#include "service/benchmarks/thirty_runs.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include "acquisition/quality_monitor.h"
#include "service/benchmarks/simulated_strokes.h"
#include "service/output.h"
#include "service/report_statistics.h"

namespace hydroscope {
namespace {

constexpr double kZeroCelsius = 273.15;  ///< K

struct Watched {
  const char* name;
  int estimate;   ///< index in StrokeRecord::estimates
  double factor;  ///< SI to the unit shown
  const char* unit;
};
constexpr std::array<Watched, 3> kWatched = {
    {{"Q_vn", 2, 6e4, "l/min"}, {"K'", 0, 1e-9, "GPa"}, {"V0", 1, 1e3, "l"}}};

/// What was known after one run.
struct RunResult {
  double oil = 0;         ///< degC, mean over the strokes
  double gated_time = 0;  ///< s that entered the equations
  int strokes = 0;
  std::vector<Estimate> estimates;
};

PressOptions RunOptions(const ThirtyRunsOptions& o, int run) {
  PressOptions press;
  press.seconds = o.seconds;
  press.seed = o.seed * 1000 + run;
  const double step = (o.oil_last - o.oil_first) / o.runs;
  press.oil_start = o.oil_first + step * run + kZeroCelsius;
  press.oil_end = press.oil_start + step;
  press.effects = {{"oil_viscosity", o.viscosity, {}}};
  return press;
}

/// One run through a pipeline of its own that starts from `state` and leaves its own there.
Result<RunResult> Run(const PressOptions& press, std::vector<std::uint8_t>& state) {
  const Machine machine = MachineFor(press);
  RunResult result;
  auto pipeline = Pipeline::Create(machine, press.sample_period, [&](StrokeRecord&& record) {
    ++result.strokes;
    result.oil += record.summary.oil_temperature - kZeroCelsius;
    result.gated_time += static_cast<double>(record.summary.counters.used) * press.sample_period;
    if (!record.estimates.empty()) result.estimates = std::move(record.estimates);
  });
  if (!pipeline) return tl::unexpected(pipeline.error());
  if (!state.empty())
    if (const Status restored = (*pipeline)->RestoreState(state); !restored)
      return tl::unexpected(restored.error());
  SampleBlock rows = RowsOf(SimulatePress(press), machine);
  QualityMonitor monitor(machine, press.sample_period);
  monitor.Inspect(rows);
  (*pipeline)->Process(rows);
  monitor.Flush(rows);
  (*pipeline)->Process(rows);
  (*pipeline)->Finish();
  state = (*pipeline)->SaveState();
  if (result.strokes == 0 || result.estimates.empty())
    return BadInput("a run of {:.0f} s gave no estimate; take --seconds 20 or more", press.seconds);
  result.oil /= result.strokes;
  return result;
}

void PrintRun(int run, const RunResult& r) {
  std::cout << fmt::format("{:>3} {:>7.2f} {:>8}", run + 1, r.oil, r.strokes);
  for (const Watched& w : kWatched)
    std::cout << fmt::format(" {:>10.4f} ± {:<7.4f}", r.estimates[w.estimate].value * w.factor,
                             r.estimates[w.estimate].std * w.factor);
  std::cout << "\n";
}

/// Slope of a watched parameter over the oil temperature, in shown units per K.
TestedValue SlopeOf(const Watched& w, const std::vector<RunResult>& runs, double least_correlation) {
  std::vector<double> ones, oil, value, std;
  for (const RunResult& r : runs) {
    ones.push_back(1);
    oil.push_back(r.oil);
    value.push_back(r.estimates[w.estimate].value * w.factor);
    std.push_back(0);  // successive estimates scatter alike
  }
  const CorrelatedFit fit = FitCorrelated({ones, oil}, value, std, least_correlation);
  return fit.coefficients.empty() ? TestedValue() : fit.coefficients[1];
}

}  // namespace

int RunThirtyRuns(const ThirtyRunsOptions& options) {
  std::vector<RunResult> runs;
  std::vector<std::uint8_t> state;
  std::cout << fmt::format(
      "{} consecutive runs of {:.0f} s, oil {} -> {} degC, flow gain {:+.2f} %/K, seed {}\n\n", options.runs,
      options.seconds, options.oil_first, options.oil_last, 100 * options.viscosity, options.seed);
  std::cout << fmt::format("{:>3} {:>7} {:>8}", "run", "oil °C", "strokes");
  for (const Watched& w : kWatched)
    std::cout << fmt::format(" {:>12} ± std   ", fmt::format("{} {}", w.name, w.unit));
  std::cout << "\n";
  ProgressBar progress("thirty runs", "runs");
  double gated_time = 0;
  for (int run = 0; run < options.runs; ++run) {
    auto result = Run(RunOptions(options, run), state);
    if (!result) return ReportError(result.error());
    PrintRun(run, *result);
    gated_time += result->gated_time;
    runs.push_back(std::move(*result));
    progress.Update((run + 1.0) / options.runs, run + 1);
  }
  const PressOptions first = RunOptions(options, 0);
  // One run is forgotten at the pace of the estimator's time constant, so successive values are correlated.
  const double memory = std::exp(-gated_time / options.runs / MachineFor(first).estimator.time_constant);
  const double true_flow_slope = options.viscosity * first.machine.Q_vn * kWatched[0].factor;
  std::cout << fmt::format(
      "\nslope over the oil temperature, 95 % interval (successive runs correlated by {:.2f} or more)\n",
      memory);
  bool reached = true;
  for (const Watched& w : kWatched) {
    const bool follows = w.estimate == 2;
    const TestedValue slope = SlopeOf(w, runs, memory);
    const double truth = follows ? true_flow_slope : 0, half = slope.HalfWidth();
    const bool holds = std::abs(slope.value - truth) <= half;
    const bool zero = std::abs(slope.value) <= half;
    const bool right = holds && zero != follows;
    reached = reached && right;
    std::cout << fmt::format("{:<5} {:>9.4f} ± {:<8.4f} {}/K, truth {:.4f}: {} the truth, {} 0{}\n", w.name,
                             slope.value, half, w.unit, truth, holds ? "holds" : "does NOT hold",
                             zero ? "holds" : "excludes", right ? "" : "  <- missed");
  }
  std::cout << (reached ? "\nreached" : "\nNOT reached")
            << ": Q_vn follows the oil temperature, K' and V0 do not\n";
  return reached ? 0 : 1;
}

}  // namespace hydroscope
