#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/units.h"
#include "diagnosis/remainder/remainder_shape.h"

namespace hydroscope {

/// Where the model errs, best first, a line each; "" if nothing is located. `unit` is the output's (OutputUnit), `factor`
/// its factor. `output`: which of several this is about.
std::string LocatedText(const std::vector<Located>& located, const DisplayUnit& unit,
                        const std::string& output = "");
/// The array "located" of `explain` and `compare`; errors in the output's unit.
nlohmann::json LocatedJson(const std::vector<Located>& located, double factor);
/// The array "maps": all of one signal and the best of two, with all their cells, in units as shown.
nlohmann::json MapsJson(const ErrorLocation& location, const std::vector<ResidualSignal>& signals,
                        double factor);

/// The curve of what is missing, for a person to recognise; `unit` and `factor` from SI of its values. `equation`: that of a model
/// with states which it adds to.
std::string RemainderText(const RemainderShape& shape, double factor, std::string_view unit,
                          const std::string& equation = "");
nlohmann::json RemainderJson(const RemainderShape& shape, double factor);

}  // namespace hydroscope
