#pragma once

#include <string>

namespace hydroscope {

/// "1.21 ± 0.02", both with the same number of decimals, two digits of the half width; small and large values with an
/// exponent: "(4.51 ± 0.03)e-12".
std::string WithInterval(double value, double half_width);

/// The same, but with three digits of a value that is smaller than its half width, "0.0591 ± 17": of parameters that only move
/// together each has a wide interval, and what they were found at is still what the model runs with.
std::string FoundWithInterval(double value, double half_width);

/// The same of a change, "+1.21 ± 0.02".
std::string ChangeWithInterval(double change, double half_width);

/// Significant digits for a value and the ends of its interval: as many that two of the half width are among them, 5 to 9.
int DigitsFor(double value, double half_width);

/// A value with its 95 % interval in the unit people read: "1.210 ± 0.012 GPa", from SI.
std::string ShownWithInterval(double value, double std, const std::string& si_unit);

}  // namespace hydroscope
