#pragma once

#include <chrono>

#include "core/clock.h"

namespace hydroscope {

/// The host's clocks.
inline HostTime RealTime() {
  using std::chrono::duration_cast, std::chrono::nanoseconds;
  return {duration_cast<nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count(),
          duration_cast<nanoseconds>(std::chrono::system_clock::now().time_since_epoch()).count()};
}

/// s since 1970-01-01 UTC.
inline double WallSeconds() { return Seconds(RealTime().wall_ns); }

}  // namespace hydroscope
