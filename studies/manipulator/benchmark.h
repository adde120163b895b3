#pragma once

#include <cstdint>

namespace hydroscope {

struct ManipulatorBenchmarkOptions {
  int cases = 60;  ///< drawn machines, each identified from its own record
  std::uint64_t seed = 1;
  double seconds = 60;   ///< of each record
  int effects = 0;       ///< logs with a hidden effect, or none, that are explained
  int first_effect = 0;  ///< number of the first of them: effects in turn, then a healthy log
  int threads = 0;
};

/// Prints how well parameters are identified, how well the arm follows the paper's path with them beside the published
/// figures, and, where asked for, how often hidden effects are named. 0 if all goals are reached, else 1.
int RunManipulatorBenchmark(const ManipulatorBenchmarkOptions& options);

}  // namespace hydroscope
