#pragma once

#include <span>
#include <vector>

#include "core/records/estimate.h"
#include "core/told.h"
#include "models/machine.h"

namespace hydroscope {

/// Of a machine in closed loop, that a signal is reversed (ReversedSignal); "" of others. `parameters`: all of the model.
Told ReversedIn(const Machine& machine, std::span<const Estimate> parameters);

/// What makes estimates of a machine doubtful however narrow their intervals are: values that no such machine has
/// (UnusualParameters), and signals that are reversed (ReversedIn).
std::vector<Told> DoubtsOf(const Machine& machine, std::span<const Estimate> parameters);

}  // namespace hydroscope
