#pragma once

#include <cstdint>
#include <string>

#include "diagnosis/states/explain_states.h"
#include "simulator/own_states/machines.h"

namespace hydroscope {

struct StateMachinesOptions {
  int cases = 36;
  int first = 0;  ///< number of the first case
  std::uint64_t seed = 1;
  int rows = 2000;  ///< of ideal logs; measured ones have 1000 to 8000
  int threads = 0;  ///< 0: as many as the computer has cores
};

/// One simulated machine with the file a user would write for it.
struct StateMachineCase {
  SimulatedStates simulated;
  bool known = true;  ///< what is hidden is among the effects of the file
};

/// The machine file of a kind; `without` is left out of its effects.
Machine StatesMachine(StateMachineKind kind, const std::string& without = {});
/// The log as one episode.
Episode EpisodeOf(const StatesLog& log, const Machine& machine);
/// Healthy, hidden and known, hidden and unknown ones of each kind in turn.
StateMachineCase CaseNumber(int number, const StateMachinesOptions& options);

/// What `hydroscope benchmark state-machines` counts.
struct StateMachinesScore {
  void Add(const StateMachinesScore& other);

  int hidden = 0, first = 0;         ///< known effects hidden; named first
  int unknown_law = 0, unknown = 0;  ///< laws outside the file; called unknown
  int healthy = 0, adequate = 0;
  int wrong = 0, cases = 0;  ///< a set without the truth
  double worst_ratio = 0;    ///< error of the next log, free run, over its noise, where the effect was named
};

/// What one case gave.
struct StateMachineOutcome {
  StateMachinesScore score;
  bool measured = false;
  std::string line;  ///< of the table
};
StateMachineOutcome RunCase(int number, const StateMachinesOptions& options);

/// Prints the table. Half of the logs are ideal but for white noise, half as a plant would measure them. 0 if at least 95 % of the effects are named first and at most 1 % of all sets are wrong; else 1.
int RunStateMachines(const StateMachinesOptions& options);

}  // namespace hydroscope
