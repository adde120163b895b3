#pragma once

#include <vector>

namespace hydroscope {

/// Variance of white noise on a smooth signal of `n` samples, from third differences (their noise gain is
/// 1 + 9 + 9 + 1 = 20).
double WhiteNoiseVariance(const double* x, int n);

/// Variance of the white noise on a signal that may itself move from row to row, as a spool under a controller does. White
/// noise has the same energy in contrasts (+ - - +) of rows, E1, and of means of two rows, E2, each scaled to its variance;
/// motion has at least twice as much in the latter. So it is 2 E1 - E2, or 0, in that half of the windows of 16 rows that
/// moves least over all 16. 0 for fewer samples than that.
double WhitePartVariance(const double* x, int n);

/// What the first and last samples of a smoothed derivative get, where a full window does not fit.
enum class Ends {
  kHold,    ///< the nearest full window's value: fast signals
  kExtend,  ///< the line through the nearest windows: smooth signals
};

/// Derivative of the `n` samples x by a triangular window of +-`half` samples: mean of the samples after minus
/// mean of those before, into the n values of `rate`; `period` in s.
void SmoothRate(const double* x, int n, int half, double period, Ends ends, double* rate);

/// The same, extrapolated from windows of +-`half` and +-2 `half` samples so that their second-order errors cancel
/// (Richardson 1911): exact for a cubic. Nearer to an end than 2 `half` the nearest value is held.
void SharpRate(const double* x, int n, int half, double period, double* rate);

}  // namespace hydroscope
