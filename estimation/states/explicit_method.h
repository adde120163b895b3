#pragma once

#include <array>
#include <cstddef>

namespace hydroscope {

/// Dormand and Prince (1980): nodes, stages, and the difference to the embedded method of order 4.
inline constexpr int kExplicitStages = 7;
inline constexpr std::array<double, kExplicitStages> kExplicitNodes = {0,       1.0 / 5, 3.0 / 10, 4.0 / 5,
                                                                       8.0 / 9, 1,       1};
inline constexpr double kExplicitA[kExplicitStages][kExplicitStages - 1] = {
    {},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
inline constexpr std::array<double, kExplicitStages> kExplicitError = {
    71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40};

/// Step times fastest rate up to which the method is stable on the real axis.
inline constexpr double kExplicitStable = 3.3;

/// Where a stage of a step begins: out = base + step * sum_j A[kStage][j] * k[j], each of `size` numbers. The sum over the
/// stages before is written out, so that the compiler turns the loop over the numbers into vectors.
template <int kStage>
[[gnu::always_inline]] inline void BeginOfStage(const double* __restrict base, const double* __restrict k,
                                                double step, std::size_t size, double* __restrict out) {
  std::array<double, static_cast<std::size_t>(kStage)> w;
  for (std::size_t j = 0; j < kStage; ++j) w[j] = step * kExplicitA[kStage][j];
  for (std::size_t i = 0; i < size; ++i) {
    double sum = base[i];
    for (std::size_t j = 0; j < kStage; ++j) sum += w[j] * k[j * size + i];
    out[i] = sum;
  }
}

}  // namespace hydroscope
