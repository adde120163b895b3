#include "models/smooth_rate.h"

#include <algorithm>

namespace hydroscope {

double WhiteNoiseVariance(const double* x, int n) {
  double sum[4] = {};  // no sum waits for the one before
  for (int k = 3; k < n; ++k) {
    const double third = x[k] - 3 * x[k - 1] + 3 * x[k - 2] - x[k - 3];
    sum[k & 3] += third * third;
  }
  return n > 3 ? ((sum[0] + sum[1]) + (sum[2] + sum[3])) / (20.0 * (n - 3)) : 0.0;
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
