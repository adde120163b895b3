#pragma once

#include "core/told.h"
#include "replay/log_reader.h"

namespace hydroscope {

/// Why rows have no times of their own, where many (kCoarseShare) repeat the time stamp of the row before: stamps that are
/// coarser than the rows, or tell when these were stored. "" if they do not. `signals` of the machine, each of whose values
/// carries the mark of its row's stamp.
Told CoarseTimeStamps(const LogCounters& read, std::size_t signals);

}  // namespace hydroscope
