#pragma once

#include <cstdint>
#include <string>

namespace hydroscope {

struct DriftBenchmarkOptions {
  double axis_years = 10;  ///< of 365 days of 1 500 strokes, healthy
  int faults = 200;        ///< of each kind
  std::uint64_t seed = 1;
};

/// `hydroscope benchmark drift`: false alarms of a healthy press, delay, change time and naming of faults,
/// faults under a warm-up. Returns 0 if what was required was reached, else 1.
int RunDriftBenchmark(const DriftBenchmarkOptions& options);

}  // namespace hydroscope
