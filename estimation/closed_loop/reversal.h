#pragma once

#include <vector>

#include "core/told.h"
#include "models/closed_loop.h"

namespace hydroscope {

/// That input or output is reversed, where the gain among `parameters` has another sign than that of `known` (SI, NaN: not known;
/// may be empty). Where none is known, gains are above 0, as the laws of plants state them. "": they are not.
Told ReversedSignal(const ClosedLoopPlant& plant, const std::vector<double>& parameters,
                    const std::vector<double>& known);

}  // namespace hydroscope
