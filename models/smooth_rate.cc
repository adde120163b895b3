#include "models/smooth_rate.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "core/parallel/wide.h"

namespace hydroscope {

namespace {

/// Four at once; two sums, so that none waits for the one before.
typedef double Doubles __attribute__((vector_size(32)));

inline void ThirdDifferences(const double* x, Doubles& out) {
  Doubles a, b, c, d;
  std::memcpy(&a, x, sizeof a);
  std::memcpy(&b, x - 1, sizeof b);
  std::memcpy(&c, x - 2, sizeof c);
  std::memcpy(&d, x - 3, sizeof d);
  out = a - 3 * b + 3 * c - d;
}

/// Mean energy of the contrasts + - - + of means of `Rows` rows over `n` rows from x on; white noise has its variance.
template <int Rows>
double ContrastEnergy(const double* x, int n) {
  double energy = 0;
  for (int first = 0; first < n; first += 4 * Rows) {
    double contrast = 0;
    for (int k = 0; k < 4 * Rows; ++k) contrast += k < Rows || k >= 3 * Rows ? x[first + k] : -x[first + k];
    energy += contrast * contrast;
  }
  return energy / n;
}

HYDROSCOPE_WIDE double NoiseVariance(const double* x, int n) {
  if (n <= 3) return 0.0;
  Doubles even{}, odd{};
  int k = 3;
  for (; k + 8 <= n; k += 8) {
    Doubles first, second;
    ThirdDifferences(x + k, first);
    ThirdDifferences(x + k + 4, second);
    even += first * first;
    odd += second * second;
  }
  const Doubles sums = even + odd;
  double total = (sums[0] + sums[1]) + (sums[2] + sums[3]);
  for (; k < n; ++k) {
    const double third = x[k] - 3 * x[k - 1] + 3 * x[k - 2] - x[k - 3];
    total += third * third;
  }
  return total / (20.0 * (n - 3));
}

HYDROSCOPE_WIDE void PutSmoothRate(const double* x, int n, int half, double period, Ends ends, double* rate) {
  const int m = std::clamp((n - 1) / 2, 1, half);
  if (n < 3) {
    std::fill_n(rate, n, 0.0);
    return;
  }
  double before = 0, after = 0;
  for (int k = 0; k < m; ++k) {
    before += x[k];
    after += x[m + 1 + k];
  }
  const double scale = 1.0 / (m * (m + 1) * period);
  for (int k = m; k + m < n; ++k) {
    rate[k] = scale * (after - before);
    if (k + m + 1 < n) {
      before += x[k] - x[k - m];
      after += x[k + m + 1] - x[k + 1];
    }
  }
  const int last = n - m - 1;
  const int reach = std::min(2 * m, last - m);
  const bool extend = ends == Ends::kExtend && reach > 0;
  const double rise = extend ? (rate[m + reach] - rate[m]) / reach : 0.0;
  const double fall = extend ? (rate[last] - rate[last - reach]) / reach : 0.0;
  for (int k = 1; k <= m; ++k) {
    rate[m - k] = rate[m] - k * rise;
    rate[last + k] = rate[last] + k * fall;
  }
}

HYDROSCOPE_WIDE void PutSharpRate(const double* x, int n, int half, double period, double* rate) {
  const int m = std::clamp((n - 1) / 4, 1, half);
  if (n < 5) {
    PutSmoothRate(x, n, half, period, Ends::kHold, rate);
    return;
  }
  // Sums over the m samples next to sample k, and over the m beyond those.
  double before = 0, after = 0, far_before = 0, far_after = 0;
  for (int k = 0; k < m; ++k) {
    far_before += x[k];
    before += x[m + k];
    after += x[2 * m + 1 + k];
    far_after += x[3 * m + 1 + k];
  }
  // Of a cubic c t^3 a window of +-m samples sees c m (m + 1) period^2 / 2 too much.
  const double share = (m + 1) / (3.0 * m + 1);
  const double narrow = (1 + share) / (m * (m + 1) * period), wide = share / (2 * m * (2 * m + 1) * period);
  const int first = 2 * m, last = n - 1 - 2 * m;
  for (int k = first;; ++k) {
    rate[k] = narrow * (after - before) - wide * ((after + far_after) - (before + far_before));
    if (k == last) break;
    far_before += x[k - m] - x[k - 2 * m];
    before += x[k] - x[k - m];
    after += x[k + m + 1] - x[k + 1];
    far_after += x[k + 2 * m + 1] - x[k + m + 1];
  }
  std::fill_n(rate, first, rate[first]);
  std::fill_n(rate + last + 1, n - 1 - last, rate[last]);
}

}  // namespace

double WhiteNoiseVariance(const double* x, int n) { return NoiseVariance(x, n); }

double WhitePartVariance(const double* x, int n) {
  constexpr int kRows = 16, kMostWindows = 64;
  struct Window {
    double motion, pairs, rows;
  };
  std::array<Window, kMostWindows> windows;
  const int all = n / kRows, taken = std::min(all, kMostWindows), quiet = (taken + 1) / 2;
  if (taken == 0) return 0.0;
  for (int w = 0; w < taken; ++w) {
    const double* first = x + w * all / taken * kRows;
    windows[w] = {ContrastEnergy<4>(first, kRows), ContrastEnergy<2>(first, kRows),
                  ContrastEnergy<1>(first, kRows)};
  }
  std::nth_element(windows.begin(), windows.begin() + quiet - 1, windows.begin() + taken,
                   [](const Window& a, const Window& b) { return a.motion < b.motion; });
  double white = 0;
  for (int w = 0; w < quiet; ++w) white += 2 * windows[w].rows - windows[w].pairs;
  return std::max(0.0, white / quiet);
}

void SmoothRate(const double* x, int n, int half, double period, Ends ends, double* rate) {
  PutSmoothRate(x, n, half, period, ends, rate);
}

void SharpRate(const double* x, int n, int half, double period, double* rate) {
  PutSharpRate(x, n, half, period, rate);
}

}  // namespace hydroscope
