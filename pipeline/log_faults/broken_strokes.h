#pragma once

#include <cstdint>
#include <span>

#include "acquisition/quality_monitor.h"
#include "core/told.h"
#include "models/machine.h"

namespace hydroscope {

/// Why the `strokes` of a log that could be used do not speak for all of it: bad readings broke up more than those, into `discarded`
/// pieces. A sentence; "" if they do.
Told BrokenUp(std::span<const ChannelQuality> channels, const Machine& machine, std::int64_t strokes,
              std::int64_t discarded);

}  // namespace hydroscope
