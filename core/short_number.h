#pragma once

#include <string>

namespace hydroscope {

/// A number that "%g" wrote, as people read it: whole up to a million, "12345" in place of "1.23e+04", and "2.14e7" in place
/// of "2.14e+07".
std::string AsPeopleRead(std::string written, double value);

/// `digits` significant ones, all of those before the point: "0.0123", "12345", "4.51e-12".
std::string ShortNumber(double value, int digits = 3);

}  // namespace hydroscope
