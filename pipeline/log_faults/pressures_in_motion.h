#pragma once

#include <cstddef>
#include <vector>

#include "models/machine.h"

namespace hydroscope {

/// Signals of a machine whose pressures are looked at while it moves.
struct PressuresInMotion {
  std::size_t position = 0;            ///< signal that moves with the machine
  std::vector<std::size_t> pressures;  ///< empty: no signal tells that it moves
};

PressuresInMotion PressuresInMotionOf(const Machine& machine);

}  // namespace hydroscope
