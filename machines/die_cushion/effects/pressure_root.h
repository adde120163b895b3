#pragma once

#include <algorithm>
#include <cmath>

namespace hydroscope::effects {

inline constexpr double kLeastDrop = 2e5;  ///< Pa; below it the root of a pressure drop is taken as linear
inline constexpr double kLeastDropRoot = 447.21359549995793;  ///< its root

/// Change of the flow root if the pressure in chamber A is `b` Pa less than read: root(dp - b) - root(dp) to
/// tank (y >= 0), root(dp + b) - root(dp) from the supply; `root` is that of what was read, without sign.
inline double RootShift(double root, double y, double b) {
  const double present = std::max(std::abs(root), kLeastDropRoot), dp = present * present;
  return std::sqrt(std::max(y >= 0 ? dp - b : dp + b, 0.25 * kLeastDrop)) - present;
}

}  // namespace hydroscope::effects
