#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace hydroscope {

/// SDIRK method of order 4 with five stages, L-stable, with an embedded method of order 3 (Hairer and Wanner
/// 1996, table IV.6.5).
inline constexpr int kImplicitStages = 5;
inline constexpr double kImplicitOwn = 0.25;  ///< weight of a stage's own rate in it
inline constexpr std::array<double, kImplicitStages> kImplicitNodes = {1.0 / 4, 3.0 / 4, 11.0 / 20, 1.0 / 2,
                                                                       1};
inline constexpr double kImplicitA[kImplicitStages][kImplicitStages] = {
    {1.0 / 4},
    {1.0 / 2, 1.0 / 4},
    {17.0 / 50, -1.0 / 25, 1.0 / 4},
    {371.0 / 1360, -137.0 / 2720, 15.0 / 544, 1.0 / 4},
    {25.0 / 24, -49.0 / 48, 125.0 / 16, -85.0 / 12, 1.0 / 4}};
inline constexpr std::array<double, kImplicitStages> kImplicitError = {
    59.0 / 48 - 25.0 / 24, -17.0 / 96 + 49.0 / 48, 225.0 / 32 - 125.0 / 16, -85.0 / 12 + 85.0 / 12, -1.0 / 4};

/// a = LU with pivots from the columns, n x n, row by row; the diagonal of U is left as its inverse. What is singular leaves numbers
/// that are not finite. For few states, where a factorisation of any size costs more than what it computes.
inline void FactorFew(std::size_t n, double* a, std::size_t* pivots) {
  for (std::size_t c = 0; c < n; ++c) {
    std::size_t pivot = c;
    for (std::size_t r = c + 1; r < n; ++r)
      if (std::abs(a[r * n + c]) > std::abs(a[pivot * n + c])) pivot = r;
    pivots[c] = pivot;
    for (std::size_t j = 0; pivot != c && j < n; ++j) std::swap(a[c * n + j], a[pivot * n + j]);
    const double inverse = 1 / a[c * n + c];
    a[c * n + c] = inverse;
    for (std::size_t r = c + 1; r < n; ++r) {
      if (a[r * n + c] == 0) continue;
      const double factor = a[r * n + c] *= inverse;
      for (std::size_t j = c + 1; j < n; ++j) a[r * n + j] -= factor * a[c * n + j];
    }
  }
}

/// b = (LU)^-1 b of what FactorFew left; `Number`: one, or several side by side.
template <typename Number>
[[gnu::always_inline]] inline void SolveFactored(std::size_t n, const double* a, const std::size_t* pivots,
                                                 Number* b) {
  for (std::size_t c = 0; c < n; ++c)
    if (pivots[c] != c) std::swap(b[c], b[pivots[c]]);
  for (std::size_t r = 1; r < n; ++r)
    for (std::size_t c = 0; c < r; ++c) b[r] -= a[r * n + c] * b[c];
  for (std::size_t r = n; r-- > 0;) {
    for (std::size_t c = r + 1; c < n; ++c) b[r] -= a[r * n + c] * b[c];
    b[r] *= a[r * n + r];
  }
}

}  // namespace hydroscope
