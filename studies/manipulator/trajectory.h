#pragma once

#include "studies/manipulator/benchmark.h"

namespace hydroscope {

/// Prints the condition number and the mean width of the rigid bodies' intervals of records along drawn series and along the
/// designed one of the same ranges. False if the designed one is no better than their mean.
bool PrintTrajectories(const ManipulatorBenchmarkOptions& options);

}  // namespace hydroscope
