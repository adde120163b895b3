#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace hydroscope {

/// Least squares of a constant, a sine and its harmonics:
///   x_n = c_0 + sum_{k=1..H} 2 Re( c_k exp(i k (phase + omega n)) ) + residual.
/// Over whole periods with a whole number of samples this is the orthogonal correlation of Isermann and
/// Muenchhof (2011, eq. 4.23 ff.); elsewhere it stays free of the leakage that correlation would suffer.
struct HarmonicFit {
  std::vector<std::complex<double>> coefficients;  ///< c_0 ... c_H; the amplitude of harmonic k is 2 |c_k|
  double residual_variance = 0;  ///< mean square of the residual, corrected for what was fitted
  std::size_t samples = 0;

  std::complex<double> fundamental() const { return coefficients[1]; }
  /// Root of the power of harmonics 2...H over the fundamental, share of noise taken off; NaN if H < 2.
  double Distortion() const;
  /// Standard deviation of one harmonic's share that white noise of the residual's variance causes.
  double DistortionStd() const;
};

/// Largest number of harmonics, at most `limit`, below 0.45 of the sampling rate and with three samples or
/// more for each unknown. 0: not even the fundamental.
int HarmonicsFor(double omega, std::size_t samples, int limit = 3);

/// `omega` rad per sample, `phase` rad at the first sample; needs HarmonicsFor(...) >= harmonics >= 1.
HarmonicFit FitHarmonics(std::span<const double> signal, double omega, double phase, int harmonics);

}  // namespace hydroscope
