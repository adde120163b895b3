#include "workbench/condition_ranges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/units.h"

namespace hydroscope {
namespace {

constexpr double kAlike = 1.3;  ///< largest over smallest up to which strokes count as driven alike

}  // namespace

bool ConditionRange::varies() const { return low > 0 && high > kAlike * low; }

Told ConditionRange::Text() const {
  const DisplayUnit unit = DisplayUnitFor(condition.unit);
  const auto number = [&](double si) {
    const double shown = si * unit.factor + unit.offset;
    return TellNumber(std::abs(shown) >= 10 ? fmt::format("{:.0f}", shown) : fmt::format("{:.2g}", shown));
  };
  return Tell("{} to {} {}", "{} bis {} {}", number(low), number(high), unit.name);
}

void IncludeStroke(const std::vector<Condition>& conditions, const StrokeSummary& stroke,
                   std::vector<ConditionRange>& ranges) {
  if (ranges.empty())
    for (std::size_t c = 0; c < conditions.size(); ++c)
      ranges.push_back({conditions[c], stroke.conditions[c], stroke.conditions[c]});
  for (std::size_t c = 0; c < ranges.size(); ++c) {
    ranges[c].low = std::min(ranges[c].low, stroke.conditions[c]);
    ranges[c].high = std::max(ranges[c].high, stroke.conditions[c]);
  }
}

std::vector<ConditionRange> RangesOf(const std::vector<Condition>& conditions,
                                     std::span<const StrokeSummary> strokes) {
  std::vector<ConditionRange> ranges;
  for (const StrokeSummary& stroke : strokes) IncludeStroke(conditions, stroke, ranges);
  return ranges;
}

}  // namespace hydroscope
