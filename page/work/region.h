#pragma once

#include <string>

#include "core/result.h"
#include "workbench/region_errors.h"

namespace hydroscope {

/// Of "p_A:33.4:85|speed:-40:-35", as the page writes it into its address; "" is everything. Errors tell what was expected.
Result<Region> ParseRegion(const std::string& text);

}  // namespace hydroscope
