#pragma once

#include <string>
#include <utility>
#include <vector>

namespace hydroscope {

/// HTML: a table of effects that no ranking can hold, each with why; "" of none. `effects`: id and reason, plain text.
std::string UnrankedEffects(const std::vector<std::pair<std::string, std::string>>& effects);

}  // namespace hydroscope
