#pragma once

#include <cstdint>
#include <functional>

namespace hydroscope {

/// Host time of one event: the monotonic clock orders and measures, the wall clock is for people. The service
/// hands a Clock down; nothing below it asks one itself.
struct HostTime {
  std::int64_t monotonic_ns = 0;
  std::int64_t wall_ns = 0;  ///< since 1970-01-01 UTC
};
using Clock = std::function<HostTime()>;

inline constexpr std::int64_t kSecond = 1'000'000'000;  ///< ns

/// ns in s.
inline double Seconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }

}  // namespace hydroscope
