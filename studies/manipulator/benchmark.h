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

/// Prints how well the tip follows the paper's path with the datasheet's model, with what was identified, and with one group
/// of parameters from the datasheet, for several sizes of Coulomb friction, beside the published figures. False if the rms
/// error is not halved with the friction of the documents' machine.
bool PrintTracking(const ManipulatorBenchmarkOptions& options);

/// Prints the condition number and the mean width of the rigid bodies' intervals of records along drawn series and along the
/// designed one of the same ranges. False if the designed one is no better than their mean.
bool PrintTrajectories(const ManipulatorBenchmarkOptions& options);

/// Explains simulated logs with a hidden effect or none, against base parameters identified on a log before it. Prints one line
/// each and the sums. False if less than 95 % are named first or more than 1 % of the sets are wrong.
bool PrintManipulatorEffects(const ManipulatorBenchmarkOptions& options);

}  // namespace hydroscope
