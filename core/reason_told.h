#pragma once

#include "core/records.h"
#include "core/told.h"

namespace hydroscope {

/// ReasonText in the languages of the page.
Wording ReasonTold(EstimateReason reason);

}  // namespace hydroscope
