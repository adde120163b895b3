#pragma once

#include <nlohmann/json_fwd.hpp>

#include "page/watch/trend_cache.h"
#include "page/watch/trend_question.h"
#include "page/watch/watcher.h"

namespace hydroscope {

/// docs/page.md, `watch/trend`: SI units, one entry per bin. Bins, marks, limits, and of what was learned the healthy
/// value, what the oil temperature accounts for, and the curve over it.
nlohmann::json TrendJson(const TrendQuestion& question, const TrendPicture& picture,
                         const WatchedState::MachineState& machine);

}  // namespace hydroscope
