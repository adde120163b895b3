#pragma once

#include <cmath>

namespace hydroscope {

/// Stages of the longer of the two methods that StateSimulator steps by.
inline constexpr int kStateStages = 7;
/// Columns of sensitivities are padded to a multiple of this, which loops over them run in.
inline constexpr int kSensitivityPadding = 4;

/// What errors of a state in an explicit step are compared with: `largest`, the largest value it had, or, where it never left 0,
/// what its rate in the step's first stage, or in the second where that is 0, comes to in a row. An empty tank whose pump begins
/// to turn fills by a root from 0 on, whose error is the same share of the state however short the step.
inline double SizeOfState(double largest, double first_rate, double second_rate, double period) {
  return largest > 0 ? largest : period * std::abs(first_rate != 0 ? first_rate : second_rate);
}

/// Few numbers, for which a call of memmove takes longer than they do.
template <typename Number>
inline void CopyFew(const Number* from, int count, Number* to) {
  for (int i = 0; i < count; ++i) to[i] = from[i];
}

}  // namespace hydroscope
