#pragma once

#include <cstdint>

namespace hydroscope {

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

}  // namespace hydroscope
