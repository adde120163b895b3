#pragma once

#include <limits>

namespace hydroscope {

/// A value with a standard deviation: value +- 1.96 std is the 95 % interval. NaN: not known.
struct ValueWithStd {
  double value = std::numeric_limits<double>::quiet_NaN();
  double std = std::numeric_limits<double>::quiet_NaN();
};

/// What a valve check leaves for the trend database: the model's figures and the conditions they hold for.
struct ValveCheck {
  double time = 0;                 ///< s, start of the record
  ValueWithStd natural_frequency;  ///< Hz
  ValueWithStd damping;            ///< 1
  ValueWithStd gain;               ///< output per share of full command
  ValueWithStd dead_time;          ///< s
  ValueWithStd bandwidth;          ///< Hz
  ValueWithStd phase_90;           ///< Hz; the database does not keep it
  double amplitude = 0;            ///< share of full command, median over the points used
  /// Largest significant harmonic share of the response, 0...1; not kept either.
  double worst_distortion = 0;
  double supply_pressure = std::numeric_limits<double>::quiet_NaN();  ///< Pa, mean; NaN if not measured
  double oil_temperature = std::numeric_limits<double>::quiet_NaN();  ///< K, mean; NaN if not measured
};

}  // namespace hydroscope
