#pragma once

#include <string>
#include <vector>

#include "core/result.h"

namespace hydroscope {

/// A part of the operating space: ranges of signals in the units that maps show them in.
struct RegionRange {
  std::string signal;
  double from = 0, to = 0;
};
using Region = std::vector<RegionRange>;

/// Of "p_A:33.4:85|speed:-40:-35", as the page writes it into its address; "" is everything. Errors tell what was expected.
Result<Region> ParseRegion(const std::string& text);

}  // namespace hydroscope
