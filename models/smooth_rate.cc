#include "models/smooth_rate.h"

#include <algorithm>

#include "core/wide.h"

namespace hydroscope {

HYDROSCOPE_WIDE double WhiteNoiseVariance(const double* x, int n) {
  if (n <= 3) return 0.0;
  constexpr int kSums = 8;  // no sum waits for the one before; one vector of them
  double sum[kSums] = {};
  int k = 3;
  for (; k + kSums <= n; k += kSums)
    for (int i = 0; i < kSums; ++i) {
      const double third = x[k + i] - 3 * x[k + i - 1] + 3 * x[k + i - 2] - x[k + i - 3];
      sum[i] += third * third;
    }
  for (; k < n; ++k) {
    const double third = x[k] - 3 * x[k - 1] + 3 * x[k - 2] - x[k - 3];
    sum[0] += third * third;
  }
  const double total = ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
  return total / (20.0 * (n - 3));
}

void SmoothRate(const std::vector<double>& x, int n, int half, double period, Ends ends,
                std::vector<double>& rate) {
  const int m = std::clamp((n - 1) / 2, 1, half);
  if (n < 3) {
    std::fill_n(rate.begin(), n, 0.0);
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

}  // namespace hydroscope
