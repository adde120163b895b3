#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include "core/constants.h"
#include "estimation/frequency_response/frequency_response.h"
#include "simulator/valve/valve_sweep.h"
#include "studies/benchmarks.h"

namespace hydroscope {
namespace {

constexpr double kFullScale = 10;        // V
constexpr int kFewestForCoverage = 400;  // a coverage from fewer seeds scatters by more than 1 %

struct Variation {
  std::string name;
  ValveSweepOptions options;
  double f0_tolerance = 0.005;
  bool check_coverage = false;
};

std::vector<Variation> Variations() {
  std::vector<Variation> list;
  const auto add = [&](std::string name, auto change) -> Variation& {
    ValveSweepOptions options;
    change(options);
    list.push_back({std::move(name), options});
    return list.back();
  };
  add("published, 1 kHz", [](auto&) {}).check_coverage = true;
  add("2 kHz", [](auto& o) { o.sample_rate = 2000; }).check_coverage = true;
  add("5 kHz", [](auto& o) { o.sample_rate = 5000; }).check_coverage = true;
  add("dead time 0.5 ms", [](auto& o) { o.dead_time = 0.5e-3; }).check_coverage = true;
  add("damping 0.4", [](auto& o) { o.damping = 0.4; });
  add("damping 1.2", [](auto& o) { o.damping = 1.2; });
  add("amplitude 0.5 %", [](auto& o) { o.amplitude = 0.005; });
  add("hold 0.3 s", [](auto& o) { o.hold = 0.3; });
  add("noisy command", [](auto& o) { o.command_noise = 0.005; });
  add("noise x 10", [](auto& o) { o.noise = 6.8e-4; }).f0_tolerance = 0.02;
  return list;
}

FrequencyRecord RecordOf(const ValveSweepOptions& options) {
  ValveSweepLog log = SimulateValveSweep(options);
  for (double& u : log.U_v) u /= kFullScale;
  FrequencyRecord record;
  record.sample_period = 1 / options.sample_rate;
  record.runs.push_back({log.t.front(), std::move(log.U_v), std::move(log.y_v)});
  return record;
}

struct IntervalTally {
  const char* name;
  const char* unit;
  double factor;  // SI to `unit`
  double truth;
  double sum = 0, worst = 0;
  int inside = 0;

  void Add(const ValueWithStd& v) {
    sum += v.value;
    worst = std::max(worst, std::abs(v.value - truth));
    inside += std::abs(v.value - truth) <= kNormal95 * v.std;
  }
};

std::string Row(const std::string& variation, const IntervalTally& t, int fitted) {
  return fmt::format("{:<18} {:<7} {:>10.5g} {:>12.6g} {:>9.1f} % {:>11.3g} {}\n", variation, t.name,
                     t.truth * t.factor, t.sum / std::max(1, fitted) * t.factor,
                     100.0 * t.inside / std::max(1, fitted), t.worst * t.factor, t.unit);
}

/// Runs one variation, prints its rows, says whether it keeps its limits.
bool RunVariation(const Variation& variation, int cases, std::uint64_t seed, double& seconds, int& sweeps) {
  const ValveSweepOptions& truth = variation.options;
  std::array<IntervalTally, 4> tallies = {{{"f0", "Hz", 1, truth.f0},
                                           {"D", "", 1, truth.damping},
                                           {"K_v", "", 1, truth.gain},
                                           {"T_dead", "ms", 1e3, truth.dead_time}}};
  int fitted = 0;
  for (int i = 0; i < cases; ++i) {
    ValveSweepOptions options = truth;
    options.seed = seed + i;
    const FrequencyRecord record = RecordOf(options);
    const auto start = std::chrono::steady_clock::now();
    const auto response = MeasureFrequencyResponse(record);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    ++sweeps;
    if (!response || !response->model) continue;
    ++fitted;
    const ValveModel& m = *response->model;
    tallies[0].Add(m.natural_frequency);
    tallies[1].Add(m.damping);
    tallies[2].Add(m.gain);
    tallies[3].Add(m.dead_time);
  }
  bool kept =
      fitted == cases && tallies[0].worst <= variation.f0_tolerance * truth.f0 && tallies[3].worst <= 0.05e-3;
  for (const IntervalTally& t : tallies) {
    std::cout << Row(variation.name, t, fitted);
    const double coverage = static_cast<double>(t.inside) / std::max(1, fitted);
    if (variation.check_coverage && cases >= kFewestForCoverage)
      kept = kept && coverage >= 0.92 && coverage <= 0.98;
  }
  if (fitted < cases)
    fmt::print("{:<18} no model in {} of {} sweeps\n", variation.name, cases - fitted, cases);
  if (!kept) fmt::print("{:<18} outside its limits\n", variation.name);
  return kept;
}

}  // namespace

int RunFrfBenchmark(const FrfBenchmarkOptions& options) {
  const auto& [cases, seed] = options;
  fmt::print("Valve frequency response, {} simulated sweeps per variation, seeds from {}\n\n", cases, seed);
  fmt::print("{:<18} {:<7} {:>10} {:>12} {:>11} {:>11}\n", "variation", "figure", "truth", "mean", "in 95 %",
             "worst error");
  double seconds = 0;
  int sweeps = 0, outside = 0;
  for (const Variation& variation : Variations())
    outside += !RunVariation(variation, cases, seed, seconds, sweeps);
  fmt::print("\n{:.2f} ms per sweep to evaluate; {} variations outside their limits\n",
             1e3 * seconds / std::max(1, sweeps), outside);
  return outside == 0 ? 0 : 1;
}

}  // namespace hydroscope
