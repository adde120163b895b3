#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

namespace hydroscope {

/// A number as the API tells it: null where it is not known.
inline nlohmann::json JsonNumber(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

}  // namespace hydroscope
