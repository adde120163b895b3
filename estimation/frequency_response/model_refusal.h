#pragma once

#include "estimation/frequency_response/frequency_response.h"

namespace hydroscope {

/// Why the fitted model of a response is none, nothing if it is one: its points lie far off it, which the widened intervals do not
/// cover, since such a misfit is no noise; or what was measured cannot be a valve's. `shares` as in FrequencyRecord.
Told WhyNoModel(const FrequencyResponse& response, bool shares);

}  // namespace hydroscope
