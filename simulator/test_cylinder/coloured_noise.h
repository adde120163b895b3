#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simulator/random.h"

namespace hydroscope {

/// Second-order section of a digital filter, y = b0 u + b1 u_1 + b2 u_2 - a1 y_1 - a2 y_2.
class FilterSection {
 public:
  FilterSection(std::array<double, 3> b, std::array<double, 2> a) : b_(b), a_(a) {}
  double operator()(double u) {
    const double y = b_[0] * u + b_[1] * u_[0] + b_[2] * u_[1] - a_[0] * y_[0] - a_[1] * y_[1];
    u_ = {u, u_[0]};
    y_ = {y, y_[0]};
    return y;
  }

 private:
  std::array<double, 3> b_;
  std::array<double, 2> a_;
  std::array<double, 2> u_{}, y_{};
};

/// White noise through sections one after the other.
class ColouredNoise {
 public:
  /// First-order low pass.
  static ColouredNoise LowPass(double corner_hz, double sample_period, std::uint64_t seed);
  /// Butterworth band pass of order 6, three sections (bilinear transform of low pass to band pass).
  static ColouredNoise BandPass(double low_hz, double high_hz, double sample_period, std::uint64_t seed);

  double Next();

 private:
  ColouredNoise(std::vector<FilterSection> sections, std::uint64_t seed)
      : sections_(std::move(sections)), random_(seed) {}

  std::vector<FilterSection> sections_;
  RandomStream random_;
};

}  // namespace hydroscope
