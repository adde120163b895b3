#pragma once

#include "studies/manipulator/benchmark.h"

namespace hydroscope {

/// Explains simulated logs with a hidden effect or none, against base parameters identified on a log before it. Prints one line
/// each and the sums. False if less than 95 % are named first or more than 1 % of the sets are wrong.
bool PrintManipulatorEffects(const ManipulatorBenchmarkOptions& options);

}  // namespace hydroscope
