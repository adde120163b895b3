#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/units.h"
#include "diagnosis/remainder/locate.h"

namespace hydroscope {

/// Where the model errs, best first, a line each; "" if nothing is located. `unit` is the output's (OutputUnit), `factor`
/// its factor.
std::string LocatedText(const std::vector<Located>& located, const DisplayUnit& unit);
/// The array "located" of `explain` and `compare`; errors in the output's unit.
nlohmann::json LocatedJson(const std::vector<Located>& located, double factor);
/// One map with all its cells, in units as shown; errors in the output's unit.
nlohmann::json MapJson(const ErrorMap& map, const std::vector<ResidualSignal>& signals, double factor);

}  // namespace hydroscope
