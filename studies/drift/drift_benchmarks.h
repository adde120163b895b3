#pragma once

#include <cstdint>
#include <string>

namespace hydroscope {

/// Studies of the drift watch and of what it is made of, one file each; as those of studies/benchmarks.h.

struct DriftBenchmarkOptions {
  double axis_years = 10;  ///< of 365 days of 1 500 strokes, healthy
  int faults = 200;        ///< of each kind
  std::uint64_t seed = 1;
};

/// `hydroscope benchmark drift`: false alarms of a healthy press, delay, change time and naming of faults,
/// faults under a warm-up. Returns 0 if what was required was reached, else 1.
int RunDriftBenchmark(const DriftBenchmarkOptions& options);

struct DriftFullSimulationOptions {
  int machines = 12;        ///< half with pressures and speeds at random, half with three products
  int commissioning = 300;  ///< strokes
  double learned_to = 60;   ///< degC, warmest oil of commissioning
  int healthy = 1500;       ///< strokes that follow
  int faulty = 120;         ///< strokes of each fault
  std::uint64_t seed = 1;
  bool details = false;  ///< print each finding
};

/// `hydroscope benchmark drift-full`: the same questions as `benchmark drift`, on fully simulated logs sent
/// through quality monitor and pipeline, machines with parameters at random. Returns 0 if what was required
/// was reached, else 1.
int RunDriftFullSimulation(const DriftFullSimulationOptions& options);

struct SinceOptions {
  int cases = 100;         ///< histories
  std::uint64_t seed = 1;  ///< of the whole campaign
  std::string effect;      ///< what appears where one effect does, "" = any of the simulator
  std::string details;     ///< one line per history to this tab-separated file, "" = none
};

/// What changed at a known time: logs of a simulated machine before and after are replayed into a trend
/// database and `explain --since` is asked. In half of the histories one effect appears; in the others it
/// appears beside one that was there, one grows, only a parameter of the machine moves, or nothing changes,
/// with and without an effect that was there all the time. Prints per kind how often the right cause stood
/// first and in the set, how often another one was named instead of it or beside it, and how often nothing
/// was said. Returns 0 if every goal is reached, else 1.
int RunSinceBenchmark(const SinceOptions& options);

struct ThirtyRunsOptions {
  int runs = 30;
  double seconds = 40;       ///< of each run
  double oil_first = 26;     ///< degC at the beginning of the first run ...
  double oil_last = 32;      ///< ... and at the end of the last
  double viscosity = 0.006;  ///< 1/K, true change of the valve's flow with the oil temperature
  std::uint64_t seed = 1;
  int seeds = 1;  ///< repetitions with seeds seed, seed + 1, ...; the table of runs is that of the first
  std::string database;  ///< trend database of the first seed, must not exist yet; "" = a temporary one
  std::string report;    ///< HTML report of the first seed, "" = none
};

/// Consecutive simulated runs while the oil warms up (figure 18 of the press paper), written as logs and
/// replayed into a trend database, each run starting from the state the one before left. Q_vn, K' and V0 are
/// regressed on the oil temperature twice: fitted to each run by itself over the run's mean temperature, as
/// published, and as the recursive estimator's trend has them after each run over the temperature the
/// estimate stands for. Returns 0 if for the first seed both 95 % intervals of the slope of Q_vn exclude 0
/// and hold the truth, those of K' and V0 hold 0, and the report says the same, and if over all seeds at most
/// 5 % of the reports claim that K' or V0 moves, follows the oil or changed, and all that Q_vn follows; else
/// 1; the exit code of the error if files cannot be written.
int RunThirtyRuns(const ThirtyRunsOptions& options);

}  // namespace hydroscope
