#pragma once

#include <vector>

#include "core/told.h"
#include "models/machine.h"

namespace hydroscope {

/// Two signals of a machine file that read the same values.
struct DoubledSignals {
  int first = 0, second = 0;  ///< of Machine::signals
  bool live = false;          ///< by where they come from live; else by the column of a log
  Told text;
};

/// All pairs that share a column, or a place that a live source reads. Seldom meant (a valve without a sensor of its spool
/// whose command stands for both), and then harmless; most often a line that was copied.
std::vector<DoubledSignals> DoubledSignalsOf(const Machine& machine);

}  // namespace hydroscope
