#pragma once

#include "models/machine.h"

namespace hydroscope {

/// The machine of a log with the columns t, p and z.
inline Machine MachineOfTwoSignals() {
  Machine machine;
  machine.log.time_column = "t";
  machine.log.time_unit = "s";
  for (const char* name : {"p", "z"}) {
    SignalSpec signal;
    signal.name = signal.column = name;
    signal.unit = "1";
    machine.signals.push_back(signal);
  }
  return machine;
}

}  // namespace hydroscope
