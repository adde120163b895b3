#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hydroscope {

/// Machines with states of which a user would write the equations: written out here by hand and integrated with small fixed
/// steps, without a word of the estimator's.
enum class StateMachineKind {
  kOscillator,  ///< lightly damped, sampled some nine times per period
  kTanks,       ///< two in a row, the level of the second is measured
  kActuator,    ///< valve, cylinder and a load on a spring; pressure and speed are measured
};

/// What is hidden in it, "" = nothing: kOscillator cubic, drag, coulomb; kTanks overflow, spill (overflow of which a part
/// falls into the second tank), leak; kActuator coulomb, root_flow.
struct SimulatedStates {
  StateMachineKind kind = StateMachineKind::kOscillator;
  std::string hidden;
  std::uint64_t seed = 1;  ///< of parameters, input and noise
  int rows = 3000;
  /// As a log of a plant: sensors with gain and zero, a converter's steps, noise partly coloured, a sensor that ends below the
  /// highest values, an input whose converter has a gain of its own, a small further law and a small disturbance of the
  /// process, some initial state, five to fifteen rows per period, excitations of all sorts.
  bool measured = false;
  /// Share of a row by which the outputs of a row are newer than its input: a logger that reads its channels in turn.
  double newer = 0;
};

struct StatesLog {
  std::vector<double> time, input;
  std::vector<std::vector<double>> outputs;  ///< NaN where the sensor was at its end: readers leave that out
  /// Per output, standard deviation of what no model can know: noise, with what small law and disturbance do.
  std::vector<double> noise;
};

StatesLog SimulateStates(const SimulatedStates& simulated);

}  // namespace hydroscope
