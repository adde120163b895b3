#pragma once

#include <cmath>
#include <optional>

namespace hydroscope {

/// A value within this many standard deviations of zero has no percentages: they would be those of its noise.
inline constexpr double kClearOfZero = 4;
/// A change beyond this multiple of the value it started from (200 %) is told in the unit: the start was
/// nearly nothing, and "+197223 %" says no more than that.
inline constexpr double kMostRelative = 2;

/// A change as a share of the value `before` (1: 100 %), for every place that prints percentages; nullopt where a
/// percentage says nothing and the change is to be told in the unit. `before_std`: SI, 0 if not known.
inline std::optional<double> RelativeChange(double before, double before_std, double change) {
  const double size = std::abs(before);
  const bool clear = std::isfinite(size) && size > 0 && !(size < kClearOfZero * before_std);
  if (!clear || !(std::abs(change) <= kMostRelative * size)) return std::nullopt;
  return change / size;
}

}  // namespace hydroscope
