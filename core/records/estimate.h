#pragma once

#include <limits>
#include <string>

namespace hydroscope {

/// Why a parameter was not (or hardly) updated. "Not identifiable now" is a result, not an error.
enum class EstimateReason {
  kUpdated,     ///< the data told something about this parameter
  kNoStroke,    ///< no gated data since the last estimate
  kTooShort,    ///< stroke shorter than one span
  kNotExcited,  ///< alone, these data tell nothing useful about the parameter: its value rests on older ones
  kConfounded,  ///< excited, but not separable from the other parameters with these data
  kOutsidePhysics,  ///< the estimate has an inadmissible sign or size (negative bulk modulus, ...)
  kPoorSignal,      ///< quality flags left too little of the stroke
};
/// Short machine name ("updated", "not_excited", ...) used in JSON and the database.
const char* ReasonName(EstimateReason reason);
/// One sentence for the maintenance engineer.
const char* ReasonText(EstimateReason reason);

/// One physical parameter as identified at one time.
struct Estimate {
  std::string parameter;  ///< "K", "V0", "Q_vn", "y_0", ...
  double value = 0;       ///< SI
  double std = 0;         ///< SI; value +- 1.96 std is the 95 % interval
  std::string unit;       ///< SI unit
  /// 0...1: share of the parameter's information not explained by the other parameters.
  double excitation = 0;
  double last_excited = 0;  ///< s, time of the last sample that told something about it; NaN if never
  EstimateReason reason = EstimateReason::kNoStroke;
  /// K, oil temperature the value stands for: an estimate that remembers follows the oil late. NaN: not known.
  double oil_temperature = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace hydroscope
