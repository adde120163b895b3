#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace hydroscope {

/// Bins for sizes over many decades, evenly spaced on the binary logarithm. What is smaller or larger than all of them counts in the
/// first or the last.
struct LogBins {
  double per_octave, least_exponent;
  std::size_t count;

  std::size_t Of(double size) const {
    const double bin = per_octave * (std::log2(size) - least_exponent);
    return static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(count - 1)));
  }
  /// At the lower end of a bin; half a bin on is its middle.
  double SizeAt(double bin) const { return std::exp2(bin / per_octave + least_exponent); }
};

}  // namespace hydroscope
