#pragma once

#include <vector>

namespace hydroscope {

/// Median of the magnitude of a normal variable, in its standard deviation.
inline constexpr double kNormalMedianMagnitude = 0.6745;

/// The value that `share` (0 to 1) of the `values` do not exceed, without interpolation; NaN among them
/// counts as absent, and `none` comes back when all are.
double Quantile(std::vector<double> values, double share, double none);

/// Median of the `values`, the mean of the two middle ones of an even number; NaN and `none` as above.
double Median(std::vector<double> values, double none);

}  // namespace hydroscope
