#pragma once

#include <span>
#include <vector>

#include "core/records/stroke_record.h"
#include "models/condition.h"

namespace hydroscope {

/// What strokes were driven at, from ... to.
struct ConditionRange {
  Condition condition;
  double low = 0, high = 0;  ///< SI

  /// Whether the strokes differ in it enough to tell what depends on it.
  bool varies() const;
  /// "32 to 87 mm/s"
  Told Text() const;
};

/// The range of each condition over the strokes; empty without strokes.
std::vector<ConditionRange> RangesOf(const std::vector<Condition>& conditions,
                                     std::span<const StrokeSummary> strokes);

/// Takes another stroke in.
void IncludeStroke(const std::vector<Condition>& conditions, const StrokeSummary& stroke,
                   std::vector<ConditionRange>& ranges);

}  // namespace hydroscope
