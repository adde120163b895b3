#pragma once

#include "diagnosis/drift/valve_check_monitor.h"
#include "storage/database.h"

namespace hydroscope {

/// A check that measured the valve, as the drift watch reads it. The database keeps neither its -90 degree frequency
/// nor its distortion.
ValveCheck StoredValveCheck(const ValveCheckRecord& record);

}  // namespace hydroscope
