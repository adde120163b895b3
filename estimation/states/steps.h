#pragma once

namespace hydroscope {

/// Stages of the longer of the two methods that StateSimulator steps by.
inline constexpr int kStateStages = 7;
/// Columns of sensitivities are padded to a multiple of this, which loops over them run in.
inline constexpr int kSensitivityPadding = 4;

/// Few numbers, for which a call of memmove takes longer than they do.
template <typename Number>
inline void CopyFew(const Number* from, int count, Number* to) {
  for (int i = 0; i < count; ++i) to[i] = from[i];
}

}  // namespace hydroscope
