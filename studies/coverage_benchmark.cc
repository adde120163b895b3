#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iostream>
#include <vector>

#include "core/constants.h"
#include "host/output.h"
#include "studies/benchmarks.h"
#include "studies/simulated_strokes.h"

namespace hydroscope {
namespace {

constexpr int kParameters = 4;

struct Score {
  int cases = 0, held = 0;
  double sum_z = 0, sum_z2 = 0, sum_error = 0, sum_std = 0;

  void Add(const Estimate& estimate, double truth) {
    const double error = estimate.value - truth;
    const double z = error / estimate.std;
    ++cases;
    held += std::abs(z) <= kNormal95;
    sum_z += z;
    sum_z2 += z * z;
    const double unit =
        estimate.unit == "1" ? 1e-2 : std::abs(truth);  // y_0 may be near 0: as it is, times 1e-4
    sum_error += error / unit;
    sum_std += estimate.std / unit;
  }
};

std::array<double, kParameters> Truth(const PressMachine& machine) {
  return {machine.K, machine.V0, machine.Q_vn, machine.y_0};
}

void PrintScores(const char* title, const std::vector<Estimate>& names,
                 const std::array<Score, kParameters>& scores) {
  fmt::print("\n{}\n{:<6} {:>9} {:>12} {:>14} {:>12} {:>12}\n", title, "", "coverage", "mean error",
             "mean 95 % half", "mean z", "rms z");
  for (int i = 0; i < kParameters; ++i) {
    const Score& s = scores[i];
    const double n = s.cases;
    const char* unit = names[i].unit == "1" ? "1e-4" : "%   ";
    fmt::print("{:<6} {:>7.1f} % {:>9.3f} {} {:>11.3f} {} {:>10.3f} {:>12.3f}\n", names[i].parameter,
               100 * s.held / n, 100 * s.sum_error / n, unit, 196 * s.sum_std / n, unit, s.sum_z / n,
               std::sqrt(s.sum_z2 / n));
  }
}

}  // namespace

int RunCoverageBenchmark(const CoverageOptions& options) {
  std::array<Score, kParameters> batch, recursive;
  std::vector<Estimate> names;
  int not_fitted = 0;
  ProgressBar progress("coverage", "logs");
  for (int c = 0; c < options.cases; ++c) {
    PressOptions press = RandomMachine(options.seed + c);
    press.seconds = options.seconds;
    const auto strokes = StrokesOf(SimulatePress(press), MachineFor(press));
    const auto fit = strokes ? FitBaseModel(*strokes->model, strokes->Grams(), strokes->window)
                             : Result<GramFit>(tl::unexpected(strokes.error()));
    if (!fit || strokes->strokes.back().estimates.empty()) {
      ++not_fitted;
      continue;
    }
    names = fit->parameters;
    const auto truth = Truth(press.machine);
    for (int i = 0; i < kParameters; ++i) {
      batch[i].Add(fit->parameters[i], truth[i]);
      recursive[i].Add(strokes->strokes.back().estimates[i], truth[i]);
    }
    progress.Update((c + 1.0) / options.cases, c + 1);
  }
  fmt::print("{} simulated machines, {:.0f} s each, seed {}; {} could not be fitted\n", options.cases,
             options.seconds, options.seed, not_fitted);
  if (names.empty()) return 1;
  PrintScores("batch fit over all strokes (hydroscope fit)", names, batch);
  PrintScores("recursive estimator after the last stroke (hydroscope replay)", names, recursive);
  bool held = not_fitted == 0;
  for (const Score& s : batch) held = held && s.held >= 0.92 * s.cases && s.held <= 0.98 * s.cases;
  std::cout << (held ? "\nevery batch interval holds the truth in 92 ... 98 %\n"
                     : "\nNOT every batch interval holds the truth in 92 ... 98 %\n");
  return held ? 0 : 1;
}

}  // namespace hydroscope
