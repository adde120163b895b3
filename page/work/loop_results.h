#pragma once

#include <nlohmann/json_fwd.hpp>

#include "page/work/work_results.h"

namespace hydroscope {

/// Work on a log of a machine in closed loop; the log held out is the one before, without one the references of the machine file
/// are. kExplain: LoopChangeJson. Otherwise LoopJson, its points as the lists of `response`: `f_hz`, and of gain (dB) and phase
/// (degrees) what was measured with the half of its 95 % interval, what the model gives and what the one before gave
/// (`before_gain`, `before_phase`; null where nothing is known of before). Both with `text`, what the command prints.
Result<nlohmann::json> WorkOutLoop(WorkRequest::Kind kind, const WorkInput& input);

}  // namespace hydroscope
