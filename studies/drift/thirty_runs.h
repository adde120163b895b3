#pragma once

#include <cstdint>
#include <string>

namespace hydroscope {

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
