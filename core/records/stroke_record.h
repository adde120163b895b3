#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/limits.h"
#include "core/records/estimate.h"
#include "core/records/stroke_gram.h"

namespace hydroscope {

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

/// Everything the pipeline says at the end of one stroke, and what is stored of it.
struct StrokeRecord {
  StrokeSummary summary;
  StrokeGram gram;
  std::vector<Estimate> estimates;  ///< one per parameter of the model
};

}  // namespace hydroscope
