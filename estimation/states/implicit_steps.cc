// Steps of StateSimulator by the implicit method, with its exact derivative.

#include <algorithm>
#include <array>
#include <cmath>

#include "core/limits.h"
#include "core/wide.h"
#include "estimation/states/simulation.h"
#include "estimation/states/step_tangent.h"
#include "estimation/states/steps.h"

namespace hydroscope {
namespace {

/// SDIRK method of order 4 with five stages, L-stable, with an embedded method of order 3 (Hairer and Wanner
/// 1996, table IV.6.5).
constexpr int kImplicitStages = 5;
constexpr double kGamma = 0.25;
constexpr std::array<double, kImplicitStages> kImplicitNodes = {1.0 / 4, 3.0 / 4, 11.0 / 20, 1.0 / 2, 1};
constexpr double kImplicitA[kImplicitStages][kImplicitStages] = {
    {1.0 / 4},
    {1.0 / 2, 1.0 / 4},
    {17.0 / 50, -1.0 / 25, 1.0 / 4},
    {371.0 / 1360, -137.0 / 2720, 15.0 / 544, 1.0 / 4},
    {25.0 / 24, -49.0 / 48, 125.0 / 16, -85.0 / 12, 1.0 / 4}};
constexpr std::array<double, kImplicitStages> kImplicitError = {
    59.0 / 48 - 25.0 / 24, -17.0 / 96 + 49.0 / 48, 225.0 / 32 - 125.0 / 16, -85.0 / 12 + 85.0 / 12, -1.0 / 4};

/// Numbers from which on the width of the vectors pays for the call.
constexpr std::size_t kLong = 24;

/// out = base + step * sum_j weights[j] * k[j], each of `size` numbers; the sum over `kCount` is written out, so that the
/// compiler turns the loop over the numbers into vectors.
template <int kCount>
inline void CombineOf(const double* base, const double* k, const double* weights, double step,
                      std::size_t size, double* out) {
  std::array<double, static_cast<std::size_t>(kCount)> w;
  for (std::size_t j = 0; j < kCount; ++j) w[j] = step * weights[j];
  for (std::size_t i = 0; i < size; ++i) {
    double sum = base[i];
    for (std::size_t j = 0; j < kCount; ++j) sum += w[j] * k[j * size + i];
    out[i] = sum;
  }
}

inline void CombineCounted(const double* base, const double* k, const double* weights, int count, double step,
                           std::size_t size, double* out) {
  switch (count) {
    case 0:
      std::copy_n(base, size, out);
      return;
    case 1:
      return CombineOf<1>(base, k, weights, step, size, out);
    case 2:
      return CombineOf<2>(base, k, weights, step, size, out);
    case 3:
      return CombineOf<3>(base, k, weights, step, size, out);
    case 4:
      return CombineOf<4>(base, k, weights, step, size, out);
    case 5:
      return CombineOf<5>(base, k, weights, step, size, out);
    default:
      return CombineOf<6>(base, k, weights, step, size, out);
  }
}

HYDROSCOPE_WIDE void CombineLong(const double* base, const double* k, const double* weights, int count,
                                 double step, std::size_t size, double* out) {
  CombineCounted(base, k, weights, count, step, size, out);
}

/// out = base + step * sum_j weights[j] * k[j], each of `size` numbers; count at most 6.
inline void Combine(const double* base, const double* k, const double* weights, int count, double step,
                    std::size_t size, double* out) {
  if (size < kLong)
    CombineCounted(base, k, weights, count, step, size, out);
  else
    CombineLong(base, k, weights, count, step, size, out);
}

/// b = a^-1 b by Gauss's elimination with pivots from the columns; `a` n x n and `b` n x `columns`, row by row. What is singular
/// leaves numbers that are not finite. For few states, where a factorisation of any size costs more than what it computes.
inline void SolveFew(std::size_t n, std::size_t columns, double* a, double* b) {
  for (std::size_t c = 0; c < n; ++c) {
    std::size_t pivot = c;
    for (std::size_t r = c + 1; r < n; ++r)
      if (std::abs(a[r * n + c]) > std::abs(a[pivot * n + c])) pivot = r;
    if (pivot != c) {
      std::swap_ranges(a + c * n, a + (c + 1) * n, a + pivot * n);
      std::swap_ranges(b + c * columns, b + (c + 1) * columns, b + pivot * columns);
    }
    for (std::size_t r = c + 1; r < n; ++r) {
      const double factor = a[r * n + c] / a[c * n + c];
      if (factor == 0) continue;
      for (std::size_t j = c + 1; j < n; ++j) a[r * n + j] -= factor * a[c * n + j];
      for (std::size_t j = 0; j < columns; ++j) b[r * columns + j] -= factor * b[c * columns + j];
    }
  }
  for (std::size_t r = n; r-- > 0;) {
    for (std::size_t k = r + 1; k < n; ++k)
      for (std::size_t j = 0; j < columns; ++j) b[r * columns + j] -= a[r * n + k] * b[k * columns + j];
    for (std::size_t j = 0; j < columns; ++j) b[r * columns + j] /= a[r * n + r];
  }
}

}  // namespace

/// Rates of the sensitivities at the point that RateAndSlopes looked at.
void StateSimulator::SlopesOfRate(const double* s, double* out) {
  if (added_ != nullptr) added_->evaluate(slopes_registers_.data(), u_.data(), stage_added_.data());
  RateOfSlopes({entries_, states_, columns_, added_, added_from_},
               {slopes_registers_.data(), held_.data(), stage_added_.data()}, s, out);
}

/// 1 - gamma * step * df/dx at the point that RateAndSlopes looked at, row by row; states that are held do not move.
void StateSimulator::StageMatrix(double step, double* matrix) const {
  std::fill_n(matrix, states_ * states_, 0.0);
  for (int i = 0; i < states_; ++i) matrix[i * states_ + i] = 1;
  for (const auto& [row, column, place] : entries_.by_states)
    if (held_[row] == 0) matrix[row * states_ + column] -= kGamma * step * slopes_registers_[place];
}

/// k = f(base + step * gamma * k) by Newton's method, from the k that comes in.
bool StateSimulator::SolveStage(double fraction, double step, const double* base, double* k) {
  constexpr int kIterations = 12;
  const auto n = static_cast<std::size_t>(states_);
  std::array<double, kMaxStates> x, rate, change;
  std::array<double, kMaxStates * kMaxStates> matrix;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for (int i = 0; i < states_; ++i) x[i] = base[i] + kGamma * step * k[i];
    RateAndSlopes(x.data(), fraction, rate.data());
    StageMatrix(step, matrix.data());
    for (int i = 0; i < states_; ++i) change[i] = rate[i] - k[i];
    const auto finite = [](const double* from, std::size_t count) {
      return std::all_of(from, from + count, [](double value) { return std::isfinite(value); });
    };
    if (!finite(change.data(), n) || !finite(matrix.data(), n * n)) return false;
    SolveFew(n, 1, matrix.data(), change.data());
    double worst = 0;
    for (int i = 0; i < states_; ++i) {
      k[i] += change[i];
      const double size = std::max(scale_[i], std::abs(x[i]));
      worst = std::max(worst, std::abs(step * change[i]) / std::max(size, 1e-300));
    }
    if (worst < 1e-3 * options_.tolerance) return true;
  }
  return false;
}

bool StateSimulator::ImplicitStep(double fraction, double share, double period, double& error) {
  const double step = share * period;
  const auto n = static_cast<std::size_t>(states_), size = n * static_cast<std::size_t>(columns_);
  std::array<double, kMaxStates> base, x, rate;
  std::array<double, kMaxStates * kMaxStates> matrix;
  for (int s = 0; s < kImplicitStages; ++s) {
    const auto at = static_cast<std::size_t>(s);
    Combine(x_.data(), k_.data(), kImplicitA[s], s, step, n, base.data());
    double* k = k_.data() + at * n;
    if (s > 0) std::copy_n(k - n, n, k);
    if (!SolveStage(fraction + kImplicitNodes[at] * share, step, base.data(), k)) return false;
    if (!with_slopes_) continue;
    for (std::size_t i = 0; i < n; ++i) x[i] = base[i] + kGamma * step * k[i];
    RateAndSlopes(x.data(), fraction + kImplicitNodes[at] * share, rate.data());
    Combine(s_.data(), ks_.data(), kImplicitA[s], s, step, size, stage_s_.data());
    double* ks = ks_.data() + at * size;
    SlopesOfRate(stage_s_.data(), ks);
    StageMatrix(step, matrix.data());
    SolveFew(n, static_cast<std::size_t>(columns_), matrix.data(), ks);
  }
  error = 0;
  const double* weights = kImplicitA[kImplicitStages - 1];
  for (std::size_t i = 0; i < n; ++i) {
    double sum = 0, e = 0;
    for (std::size_t s = 0; s < kImplicitStages; ++s) {
      sum += weights[s] * k_[s * n + i];
      e += kImplicitError[s] * k_[s * n + i];
    }
    next_[i] = x_[i] + step * sum;
    if (!std::isfinite(next_[i])) return false;
    const double reach = std::max({scale_[i], std::abs(x_[i]), std::abs(next_[i])});
    error = std::max(error, std::abs(step * e) / std::max(reach, 1e-300));
  }
  if (with_slopes_) Combine(s_.data(), ks_.data(), weights, kImplicitStages, step, size, stage_s_.data());
  return true;
}

}  // namespace hydroscope
