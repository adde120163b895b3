#pragma once

#include <string>
#include <vector>

#include "models/machine.h"

namespace hydroscope {

/// What proves that a signal stands still because its sensor or its wire does: either a command that it follows moves, or
/// all of `movements` take place, each of which drives it.
struct StandstillRule {
  std::string signal;
  std::string command = {};  ///< that it follows in time; "": none
  double full_command = 1;   ///< SI of the command
  double at_stop = 0;        ///< SI, magnitude from which it may rest while its command moves; 0 = nowhere
  /// SI, magnitude at which what it measures ends, as it does at the full command; 0 = not known.
  double end = 0;
  std::vector<GateBound> movements = {};  ///< levels and rates of other signals
};

}  // namespace hydroscope
