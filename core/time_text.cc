#include "core/time_text.h"

#include <fmt/chrono.h>

#include <cmath>

namespace hydroscope {

bool CountsFrom1970(double seconds) { return seconds > 1e9; }

std::string LocalTimeText(double wall) {
  return fmt::format("{:%Y-%m-%d %H:%M:%S}", fmt::localtime(static_cast<std::time_t>(wall)));
}

std::string DurationText(double seconds) {
  constexpr double kMinute = 60, kHour = 60 * kMinute, kDay = 24 * kHour;
  if (!std::isfinite(seconds)) return "-";
  if (seconds <= 0) return "0 s";
  if (seconds < 1) return fmt::format("{:.0f} ms", seconds * 1e3);
  if (seconds < 2 * kMinute) return fmt::format("{:.1f} s", seconds);
  if (seconds < 2 * kHour) return fmt::format("{:.1f} min", seconds / kMinute);
  if (seconds < 2 * kDay) return fmt::format("{:.1f} h", seconds / kHour);
  return fmt::format("{:.1f} days", seconds / kDay);
}

}  // namespace hydroscope
