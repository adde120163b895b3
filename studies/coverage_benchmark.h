#pragma once

#include <cstdint>

namespace hydroscope {

struct CoverageOptions {
  int cases = 200;
  std::uint64_t seed = 1;  ///< of the first machine
  double seconds = 120;    ///< of each log
};

/// Simulates logs of varied machines, identifies each and prints, per parameter, how often the
/// 95 % interval holds the truth, the mean error and the spread, for the batch fit and for the recursive estimator.
/// Returns 0 if every coverage of the batch fit lies within 92 ... 98 %, else 1.
int RunCoverageBenchmark(const CoverageOptions& options);

}  // namespace hydroscope
