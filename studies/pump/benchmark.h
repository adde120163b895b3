#pragma once

#include <cstdint>

namespace hydroscope {

struct PumpBenchmarkOptions {
  int machines = 20;       ///< random pumps that are fitted
  int effects = 3;         ///< logs with each hidden effect, and without one
  std::uint64_t seed = 1;  ///< of the first
  int threads = 0;         ///< 0: one per core
};

/// Prints, for random pumps: what is left of the ripple; fit on the log and on a flow pulse that was not fitted, beside the
/// published linear model on the same data; errors of the parameters, and how often their intervals hold the truth; the same
/// without the sensors of the control chamber. Then hidden effects and what is said of them. 0 if all goals are reached.
int RunPumpBenchmark(const PumpBenchmarkOptions& options);

}  // namespace hydroscope
