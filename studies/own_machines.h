#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/batch_fit.h"

namespace hydroscope {

/// A simulated cylinder of the user's own: F = A p + c + the effects that are hidden, and a library of eight
/// effects whose regressors are like one another (frictions that grow with pressure, with its square, with
/// speed ...).
struct OwnMachineCase {
  std::vector<std::string> hidden;  ///< ids of the effects that are there, 0 ... 4 of the eight
  double size = 3.0;                ///< N, rms that each of them has on average
  double noise = 0.3;               ///< N, of the force
  double unmodelled = 0.0;          ///< N, an error that all samples of a stroke share
  double lasting = 0.0;             ///< N, noise of the force that goes on from row to row: AR(1) of 0.85
  int strokes = 40;
  std::uint64_t seed = 1;
};

/// The machine file with the eight effects, none of them part of the model.
Machine OwnMachine();
/// Its strokes: pressure and speed differ from stroke to stroke and move within it.
LogStrokes OwnMachineStrokes(const OwnMachineCase& simulated, const Machine& machine);

struct OwnMachinesOptions {
  int cases = 60;  ///< and half as many with a law that the machine file lacks
  std::uint64_t seed = 1;
};

/// What `hydroscope benchmark own-machines` counts.
struct OwnMachinesScore {
  int cases = 0, exact = 0;  ///< exact: the best subset is the truth
  int in_set = 0;            ///< every hidden effect is in a group of its own
  int wrong = 0;             ///< named for certain (a group of one) and not there
  int unknown = 0, adequate = 0;
  double set_size = 0;  ///< mean effects named per hidden effect, where something is named
  /// Beside these: machines with one law that the machine file lacks; of them named all the same, without a word of doubt or with.
  int absent = 0, absent_named = 0, absent_in_doubt = 0;
};
OwnMachinesScore ScoreOwnMachines(const OwnMachinesOptions& options);

/// Prints the score. Returns 0 if at most 2 % name an effect for certain that is not there, in at least 85 % every hidden effect
/// is in the set, and at most 5 % of the laws that the machine file lacks are named without a doubt; else 1.
int RunOwnMachines(const OwnMachinesOptions& options);

}  // namespace hydroscope
