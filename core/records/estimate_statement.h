#pragma once

#include <string>
#include <vector>

#include "core/records/estimate.h"
#include "core/told.h"

namespace hydroscope {

/// What the estimator of a parameter does not know of its own estimates: it follows changes, so that what all strokes share is
/// not in its intervals. Every place that states a value by itself states it so; comparisons of strokes do without.
struct EstimateStatement {
  std::string parameter;
  /// Standard uncertainty that tolerances assumed of the geometry add, as a share of the value.
  double shared = 0;
  /// SI, at least this much: that of a fit to strokes that hang together; 0: they do not.
  double least_std = 0;
  bool confounded = false;  ///< what the strokes cannot show could move the value out of its interval
  Told why;                 ///< of `confounded`: what, and what to record; else ""

  bool operator==(const EstimateStatement&) const = default;
};

/// nullptr if there is none of the parameter.
const EstimateStatement* FindStatement(const std::vector<EstimateStatement>& statements,
                                       const std::string& parameter);

/// Widens the interval and takes the trust from an estimate that its last stroke updated (kConfounded).
void StateEstimate(const std::vector<EstimateStatement>& statements, Estimate& estimate);

}  // namespace hydroscope
