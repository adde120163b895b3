#pragma once

#include <limits>
#include <numbers>

namespace hydroscope {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNormal95 =
    1.959963984540054;                           ///< half width of the central 95 % of a normal, in std
inline constexpr double kZeroCelsius = 273.15;   ///< K
inline constexpr double kLitresPerMinute = 6e4;  ///< l/min in one m^3/s
inline constexpr double kDegrees = 180 / std::numbers::pi;  ///< in one radian
inline constexpr double kTwoPi = 2 * std::numbers::pi;

}  // namespace hydroscope
