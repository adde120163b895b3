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

/// What is hidden in it, "" = nothing: kOscillator cubic, drag, coulomb; kTanks
/// overflow, leak; kActuator coulomb, root_flow.
struct SimulatedStates {
  StateMachineKind kind = StateMachineKind::kOscillator;
  std::string hidden;
  std::uint64_t seed = 1;  ///< of parameters, input and noise
  int rows = 3000;
};

struct StatesLog {
  std::vector<double> time, input;
  std::vector<std::vector<double>> outputs;
  std::vector<double> noise;  ///< standard deviation per output
};

StatesLog SimulateStates(const SimulatedStates& simulated);

}  // namespace hydroscope
