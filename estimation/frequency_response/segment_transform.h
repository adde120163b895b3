#pragma once

#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "core/constants.h"

namespace hydroscope {

/// Half spectra of segments of one length, under a Hann window and without their mean.
class SegmentTransform {
 public:
  explicit SegmentTransform(std::size_t length)
      : window_(length), windowed_(length), spectrum_(length / 2 + 1) {
    fft_.SetFlag(Eigen::FFT<double>::HalfSpectrum);
    for (std::size_t n = 0; n < length; ++n)
      window_[n] = 0.5 - 0.5 * std::cos(kTwoPi * static_cast<double>(n) / static_cast<double>(length));
  }

  /// Of the segment whose value n is `value(n)`; valid until the next one.
  template <typename Value>
  const std::vector<std::complex<double>>& operator()(Value value) {
    double mean = 0;
    for (std::size_t n = 0; n < window_.size(); ++n) mean += windowed_[n] = value(n);
    mean /= static_cast<double>(window_.size());
    for (std::size_t n = 0; n < window_.size(); ++n) windowed_[n] = (windowed_[n] - mean) * window_[n];
    fft_.fwd(spectrum_.data(), windowed_.data(), static_cast<std::ptrdiff_t>(windowed_.size()));
    return spectrum_;
  }

 private:
  Eigen::FFT<double> fft_;
  std::vector<double> window_, windowed_;
  std::vector<std::complex<double>> spectrum_;
};

}  // namespace hydroscope
