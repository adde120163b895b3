#pragma once

#include <cstdint>

namespace hydroscope {

struct TestCylinderBenchmarkOptions {
  int seeds = 50;    ///< records of each valve
  int changes = 10;  ///< pairs of records of each change
  int threads = 0;   ///< 0: one per core
  std::uint64_t seed = 1;
};

/// The published test cylinder with both valves, simulated and identified in closed loop: our figures beside the published
/// ones, the record length asked for at five times the noise and whether it suffices, the bias of the direct ratio, what
/// `explain --since` says of changes, and what is not in the model. Returns 0 if every goal is reached, else 1.
int RunTestCylinderBenchmark(const TestCylinderBenchmarkOptions& options);

}  // namespace hydroscope
