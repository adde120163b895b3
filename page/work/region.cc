#include "page/work/region.h"

#include <optional>

#include "core/finite_number.h"

namespace hydroscope {
namespace {

constexpr std::size_t kMostRanges = 8;

}  // namespace

Result<Region> ParseRegion(const std::string& text) {
  Region region;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('|', begin), text.size());
    const std::string part = text.substr(begin, end - begin);
    const std::size_t second = part.rfind(':'),
                      first = second == part.npos || second == 0 ? part.npos : part.rfind(':', second - 1);
    if (first == part.npos || first == 0) return BadInput("where: found '{}', expected SIGNAL:FROM:TO", part);
    const auto from = FiniteNumber(std::string_view(part).substr(first + 1, second - first - 1)),
               to = FiniteNumber(std::string_view(part).substr(second + 1));
    if (!from || !to)
      return BadInput("where: found '{}', expected two numbers behind {}", part, part.substr(0, first));
    if (region.size() == kMostRanges) return BadInput("where: more than {} ranges", kMostRanges);
    region.push_back({part.substr(0, first), *from, *to});
    begin = end + 1;
  }
  return region;
}

}  // namespace hydroscope
