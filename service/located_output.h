#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "diagnosis/locate.h"

namespace hydroscope {

/// Where the model errs, best first, a line each; "" if nothing is located.
std::string LocatedText(const std::vector<Located>& located);
/// The array "located" of `explain` and `compare`; flows in l/min.
nlohmann::json LocatedJson(const std::vector<Located>& located);
/// One map with all its cells, in units as shown; flows in l/min.
nlohmann::json MapJson(const ErrorMap& map, const std::vector<ResidualSignal>& signals);

}  // namespace hydroscope
