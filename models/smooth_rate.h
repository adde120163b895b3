#pragma once

#include <vector>

namespace hydroscope {

/// Variance of white noise on a smooth signal of `n` samples, from third differences (their noise gain is
/// 1 + 9 + 9 + 1 = 20).
double WhiteNoiseVariance(const double* x, int n);

/// What the first and last samples of a smoothed derivative get, where a full window does not fit.
enum class Ends {
  kHold,    ///< the nearest full window's value: fast signals
  kExtend,  ///< the line through the nearest windows: smooth signals
};

/// Derivative by a triangular window of +-`half` samples: mean of the samples after minus mean of those
/// before. `rate` has room for the `n` samples of x; `period` in s.
void SmoothRate(const std::vector<double>& x, int n, int half, double period, Ends ends,
                std::vector<double>& rate);

}  // namespace hydroscope
