#pragma once

#include <string_view>

#include "core/told.h"

namespace hydroscope {

/// A unit, or a number with its unit, as people read it: "l/min per bar", in German "l/min je bar".
Told UnitTold(std::string_view name);

}  // namespace hydroscope
