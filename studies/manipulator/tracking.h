#pragma once

#include "studies/manipulator/benchmark.h"

namespace hydroscope {

/// Prints how well the tip follows the paper's path with the datasheet's model, with what was identified, and with one group
/// of parameters from the datasheet, for several sizes of Coulomb friction, beside the published figures. False if the rms
/// error is not halved with the friction of the documents' machine.
bool PrintTracking(const ManipulatorBenchmarkOptions& options);

}  // namespace hydroscope
