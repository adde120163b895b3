#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace hydroscope {

/// A sensor with its converter.
struct StateSensor {
  double gain = 1, zero = 0;
  double noise = 0;                                      ///< standard deviation, before the gain
  double coloured = 0;                                   ///< share of the noise's energy that remembers ...
  double memory = 0;                                     ///< ... this much of itself from row to row
  double step = 0;                                       ///< of the converter, before the gain
  double end = std::numeric_limits<double>::infinity();  ///< what is above is not shown

  /// Standard deviation of noise and steps.
  double Floor() const;
};

/// Readings of a quantity; NaN where the sensor is at its end.
std::vector<double> Sensed(const std::vector<double>& values, const StateSensor& sensor, std::uint64_t seed);

}  // namespace hydroscope
