#pragma once

#include "estimation/linear_form/linear_fit.h"
#include "studies/manipulator/benchmark.h"
#include "studies/manipulator/machine.h"

namespace hydroscope {

/// The linear form of the kind fitted to a record of a machine under the datasheet's control.
struct IdentifiedManipulator {
  LinearFit fit;
  ControllerModel model;  ///< the datasheet's, with what was identified
};
IdentifiedManipulator Identify(const ManipulatorTruth& truth, const ManipulatorMotion& motion, double seconds,
                               std::uint64_t seed);

/// Prints a table over drawn machines: error of each parameter and how often its 95 % interval holds the truth. False if that
/// is less than 90 % of all.
bool PrintIdentification(const ManipulatorBenchmarkOptions& options);

}  // namespace hydroscope
