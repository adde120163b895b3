#pragma once

namespace hydroscope {

/// x, or 0 if it is below: a sum of squares that rounding made negative. NaN stays NaN, where
/// std::max(0.0, NaN) is 0 and would pass off a figure that nobody knows as a perfect one.
constexpr double NonNegative(double x) { return x < 0.0 ? 0.0 : x; }

}  // namespace hydroscope
