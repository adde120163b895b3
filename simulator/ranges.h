#pragma once

#include <initializer_list>

#include "core/result.h"

namespace hydroscope {

/// What a number of a simulated machine may be.
struct AllowedRange {
  const char* name;
  double value, low, high;
  const char* unit = "";
};

/// Error: the first of them that lies outside, with its limits.
Status CheckRanges(std::initializer_list<AllowedRange> ranges);

}  // namespace hydroscope
