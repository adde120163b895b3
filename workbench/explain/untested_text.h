#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hydroscope {

/// Effects that could not be tested, each with why; those with the same reason stand together, in the order of the first of them.
/// `counted`: "strokes". "" if there are none.
std::string UntestedText(const std::vector<std::pair<std::string, std::string>>& why_not,
                         std::string_view counted);

}  // namespace hydroscope
