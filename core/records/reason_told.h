#pragma once

#include "core/records/estimate.h"
#include "core/told.h"

namespace hydroscope {

/// ReasonText in the languages of the page.
Wording ReasonTold(EstimateReason reason);

}  // namespace hydroscope
