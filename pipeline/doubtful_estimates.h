#pragma once

#include <span>
#include <vector>

#include "core/records/estimate.h"
#include "core/told.h"
#include "models/machine.h"
#include "storage/database.h"

namespace hydroscope {

/// Of a machine in closed loop, that a signal is reversed (ReversedSignal); "" of others. `parameters`: all of the model.
Told ReversedIn(const Machine& machine, std::span<const Estimate> parameters);

/// What makes estimates of a machine doubtful however narrow their intervals are: values that no such machine has
/// (UnusualParameters), and signals that are reversed (ReversedIn).
std::vector<Told> DoubtsOf(const Machine& machine, std::span<const Estimate> parameters);

/// The same of the newest stroke stored in `runs`, those of a machine in their order, and what was said of the log that it is of
/// (RunSummary::warnings; in English alone).
std::vector<Told> DoubtsOfNewest(const Machine& machine, std::span<const Estimate> parameters,
                                 std::span<const RunInfo> runs);

/// Adds those that do not say the same as one that is there.
void AddDoubts(std::vector<Told> more, std::vector<Told>& doubts);

}  // namespace hydroscope
