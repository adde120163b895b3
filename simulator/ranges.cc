#include "simulator/ranges.h"

#include <string_view>

namespace hydroscope {

Status CheckRanges(std::initializer_list<AllowedRange> ranges) {
  for (const auto& [name, value, low, high, unit] : ranges) {
    if (value >= low && value <= high) continue;
    if (std::string_view(unit).empty())
      return UsageError("{} {} is not within {} ... {}", name, value, low, high);
    return UsageError("{} is {} {}; it must lie between {} and {} {}", name, value, unit, low, high, unit);
  }
  return {};
}

}  // namespace hydroscope
