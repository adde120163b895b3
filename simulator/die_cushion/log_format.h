#pragma once

#include <string>
#include <string_view>

#include "simulator/die_cushion/sensors.h"

namespace hydroscope {

/// Header of a press log file: t,p_A,p_B,p_0,z,y_v,U_v,T_oil.
inline constexpr std::string_view kPressLogHeader = "t,p_A,p_B,p_0,z,y_v,U_v,T_oil\n";

/// Appends one line, T_oil in degC, all else SI; a value that is no number becomes an empty field.
void AppendPressLine(const PressRow& row, std::string& text);

}  // namespace hydroscope
