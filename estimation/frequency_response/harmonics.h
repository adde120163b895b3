#pragma once

#include <array>
#include <cmath>
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
  static constexpr int kMostHarmonics = 3;

  int harmonics = 0;                                                    ///< H
  std::array<std::complex<double>, kMostHarmonics + 1> coefficients{};  ///< c_0 ... c_H; the amplitude of
                                                                        ///< harmonic k is 2 |c_k|
  double residual_variance = 0;  ///< mean square of the residual, corrected for what was fitted
  std::size_t samples = 0;

  std::complex<double> fundamental() const { return coefficients[1]; }
  /// Root of the power of harmonics 2...H over the fundamental, share of noise taken off; NaN if H < 2.
  double Distortion() const;
  /// Standard deviation of one harmonic's share that white noise of the residual's variance causes.
  double DistortionStd() const;
};

/// Largest number of harmonics, at most HarmonicFit::kMostHarmonics, below 0.45 of the sampling rate and with
/// three samples or more for each unknown. 0: not even the fundamental.
int HarmonicsFor(double omega, std::size_t samples);

/// What a fit needs of a stretch of samples: sum of x_n exp(-i k theta_n) for each k, and of x_n^2.
struct HarmonicSums {
  std::array<std::complex<double>, HarmonicFit::kMostHarmonics + 1> correlation{};
  double square = 0;
};

/// `omega` rad per sample, `phase` rad at the first sample; needs HarmonicsFor(...) >= harmonics >= 1.
HarmonicFit FitHarmonics(std::span<const double> signal, double omega, double phase, int harmonics);

/// exp(i angle) that is turned on by `omega` from sample to sample.
class Phasor {
 public:
  explicit Phasor(double omega) : cos_step_(std::cos(omega)), sin_step_(std::sin(omega)) {}
  void Set(double angle) {
    c = std::cos(angle);
    s = std::sin(angle);
  }
  void Turn() {
    const double next = c * cos_step_ - s * sin_step_;
    s = s * cos_step_ + c * sin_step_;
    c = next;
  }
  double c = 1, s = 0;

 private:
  double cos_step_, sin_step_;
};

/// Command and response of one held frequency, prepared for fits over any number of stretches of it: the
/// samples are correlated once, and a fit takes the difference of two running sums.
class HeldSineSums {
 public:
  /// Samples `begin` ... `end` - 1 of both signals; sample n lies at the angle `omega` n.
  HeldSineSums(std::span<const double> input, std::span<const double> output, double omega, std::size_t begin,
               std::size_t end);

  struct Fits {
    HarmonicFit input, output;
    std::complex<double> Ratio() const { return output.fundamental() / input.fundamental(); }
  };
  /// `from` ... `to` - 1 within what was prepared; needs HarmonicsFor(omega, to - from) >= 1.
  Fits Fit(std::size_t from, std::size_t to) const;

 private:
  struct Channel {
    std::span<const double> signal;
    double offset = 0;                  ///< taken off every sample
    std::vector<HarmonicSums> running;  ///< up to each kStride-th sample
  };
  std::array<HarmonicSums, 2> UpTo(std::size_t end) const;

  double omega_;
  Phasor phasor_;
  std::size_t begin_;
  std::array<Channel, 2> channels_;  // command, response
};

}  // namespace hydroscope
