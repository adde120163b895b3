#pragma once

#include <vector>

#include "alarms/health.h"

namespace hydroscope {

/// Health of a press by its own alarms, and by its axes: while none of them is judged the press is not good
/// either, whatever does not stand.
Health JudgePressHealth(const std::vector<AlarmState>& alarms, const ServiceTrouble& trouble,
                        const std::vector<Health>& axes);

}  // namespace hydroscope
