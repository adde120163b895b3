#pragma once

#include <cstdint>

namespace hydroscope {

struct ThirtyRunsOptions {
  int runs = 30;
  double seconds = 40;       ///< of each run
  double oil_first = 26;     ///< degC at the beginning of the first run ...
  double oil_last = 32;      ///< ... and at the end of the last
  double viscosity = 0.006;  ///< 1/K, true change of the valve's flow with the oil temperature
  std::uint64_t seed = 1;
};

/// Consecutive simulated runs while the oil warms up (figure 18 of the press paper), the estimator's state
/// carried from run to run. Prints Q_vn, K' and V0 after each run and the regression of each on the oil
/// temperature. Returns 0 if the 95 % interval of the slope of Q_vn excludes 0 and holds the truth while
/// those of K' and V0 hold 0, else 1.
int RunThirtyRuns(const ThirtyRunsOptions& options);

}  // namespace hydroscope
