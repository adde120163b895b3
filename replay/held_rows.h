#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/told.h"
#include "models/machine.h"
#include "replay/log_reader.h"

namespace hydroscope {

/// Rows that a logger repeats: it asks more often than its source has new values, so that several signals stand still together
/// for some rows, time and again.
struct HeldRows {
  std::vector<std::size_t> signals;  ///< that stand still together
  double period = 0;                 ///< s between new values
  Told why;                          ///< what the logger does, and what is left out
};

/// Looks at the first rows of a log. Nothing if a signal that the machine needs changes from row to row, or if it is only one
/// that stands still: that one is late, the others are not (replay/held_signals.h).
std::optional<HeldRows> FindHeldRows(const SampleBlock& head, const Machine& machine);

/// `reader` without the rows in which none of the signals of `held` is new, and flags of time that follow from the others.
std::unique_ptr<LogReader> WithoutHeldRows(std::unique_ptr<LogReader> reader, HeldRows held);

}  // namespace hydroscope
