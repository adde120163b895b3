#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/limits.h"
#include "core/quality.h"

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
  double excitation =
      0;  ///< 0...1: share of the parameter's information not explained by the other parameters
  double last_excited = 0;  ///< s, time of the last sample that told something about it; NaN if never
  EstimateReason reason = EstimateReason::kNoStroke;
  /// K, oil temperature the value stands for: an estimate that remembers follows the oil late. NaN: not known.
  double oil_temperature = std::numeric_limits<double>::quiet_NaN();
};

/// How much of what entered was used, and why the rest was not.
struct StrokeCounters {
  std::int64_t samples = 0;                ///< rows seen between begin and end
  std::int64_t gated = 0;                  ///< rows inside the gate
  std::int64_t used = 0;                   ///< rows that entered a Gram
  std::array<std::int64_t, 16> flagged{};  ///< rows per quality flag (bit number)
};

/// What one entry of StrokeSummary::conditions holds.
struct ConditionName {
  std::string name, unit;  ///< SI
};

/// A stroke as stored: when, how it was driven, how well the model fitted.
struct StrokeSummary {
  std::int64_t index = 0;      ///< 0, 1, ... within the run
  double begin = 0, end = 0;   ///< s
  double oil_temperature = 0;  ///< K, mean; NaN if not measured
  /// What it was driven at, SI, in the order the machine declares (models/condition.h); NaN where not measured.
  std::array<double, kMaxConditions> conditions{};
  double rms_error = 0;    ///< SI of the output, error of the model in force before this stroke
  double noise_floor = 0;  ///< SI of the output, what sensor noise alone would cause
  StrokeCounters counters;
};

}  // namespace hydroscope
