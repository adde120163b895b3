#pragma once

#include <string>

#include "core/result.h"
#include "workbench/states/states_log.h"

namespace hydroscope {

/// The explanation of a machine with states as one self-contained HTML page: verdict in plain words, staircase of the error,
/// free run against measurement, where it errs, the law that is missing, ranking, parameters before and after. Fails if the
/// file cannot be written.
Status WriteStatesReport(const std::string& path, const StatesExplained& explained);

}  // namespace hydroscope
