#include "simulator/ranges.h"

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace hydroscope {

Status CheckRanges(std::initializer_list<AllowedRange> ranges) {
  for (const auto& [name, value, low, high, unit] : ranges) {
    if (value >= low && value <= high) continue;
    const std::string of_unit =
        std::string_view(unit) == "1" || std::string_view(unit).empty() ? "" : fmt::format(" {}", unit);
    return UsageError("{} is {}{}; it must lie between {} and {}{}", name, value, of_unit, low, high,
                      of_unit);
  }
  return {};
}

}  // namespace hydroscope
