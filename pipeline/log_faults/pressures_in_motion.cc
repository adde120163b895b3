#include "pipeline/log_faults/pressures_in_motion.h"

#include "core/units.h"
#include "models/machine_kind.h"

namespace hydroscope {

PressuresInMotion PressuresInMotionOf(const Machine& machine) {
  int position = -1;
  for (const Condition& condition : KindOf(machine).conditions)
    if (condition.of == Condition::Of::kMeanRate) position = machine.SignalIndex(condition.signal);
  PressuresInMotion found;
  if (position < 0) return found;
  found.position = static_cast<std::size_t>(position);
  for (std::size_t s = 0; s < machine.signals.size(); ++s)
    if (const auto unit = FindUnit(machine.signals[s].unit); unit && unit->si == "Pa")
      found.pressures.push_back(s);
  return found;
}

}  // namespace hydroscope
