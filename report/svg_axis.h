#pragma once

#include <string>
#include <vector>

namespace hydroscope {

/// Tick positions of one axis with their labels.
struct AxisTicks {
  std::vector<double> values;
  std::vector<std::string> labels;
  int exponent = 0;  ///< labels show value / 10^exponent; 0 for most axes
};

/// Ticks at 1, 2, 2.5 or 5 times a power of ten inside [low, high] (low < high, finite), about `target` of
/// them, labels with equal decimals. `whole` keeps the step at 1 or more (stroke numbers). Values beyond five
/// digits or below 1e-3 steps share a power of ten, a multiple of 3.
AxisTicks NiceTicks(double low, double high, int target, bool whole = false);

/// Ticks of a logarithmic axis from `low` to `high` (0 < low < high): 1 to 9 times each power of ten, with labels at 1, 2 and 5,
/// over less than a decade and a half at nearly all of them.
AxisTicks DecadeTicks(double low, double high);

/// "10⁻⁶" for -6.
std::string PowerOfTen(int exponent);

/// A range that holds [low, high] with a margin of `share` on both sides; a single value gets a range around it.
struct AxisRange {
  double low = 0, high = 1;
};
AxisRange PaddedRange(double low, double high, double share);

/// Indices of the points that a plot of `buckets` columns needs to look the same: first, least, greatest and
/// last of every bucket of equal count, in order. Non-finite values are dropped where a bucket holds others;
/// a bucket without any keeps one, so that the gap stays. All indices if there are no more than 4 * buckets.
std::vector<std::size_t> DecimateMinMax(const std::vector<double>& y, std::size_t buckets);

}  // namespace hydroscope
