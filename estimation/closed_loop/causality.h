#pragma once

#include "core/result.h"
#include "estimation/closed_loop/transfer_fit.h"

namespace hydroscope {

/// Error (kBadInput) if the output answers before the input, which no plant does: rows of a logger that is slower than the
/// controller hide where the current stepped in between, and bend poles and dampings by many standard deviations though nothing
/// is left beside the noise. So do resonances that the transfer function does not have. Columns that are whole rows apart bend none,
/// and pass. `sample_period` in s.
Status CheckCausality(const ClosedLoopPlant& plant, const LoopEstimate& estimate, double sample_period);

}  // namespace hydroscope
