#pragma once

#include <span>
#include <vector>

namespace hydroscope {

/// A run of consecutive good samples on the uniform grid, channel by channel, in SI. Channels are the model's own
/// (for the die cushion: `DieCushionChannel`), measured ones first, then those the model derives from them.
struct Stretch {
  int samples = 0;
  double period = 0.0;                        ///< s between samples
  bool continues = false;                     ///< sample 0 is the last sample of the stretch before
  std::vector<std::vector<double>> channel;   ///< [channel][sample]

  const double* operator[](int index) const { return channel[static_cast<std::size_t>(index)].data(); }
};

/// Every column of a balance is a Stieltjes integral of products of channels: increment k of a column is the
/// trapezoidal value of a * db between samples k and k + 1. From the increments follow the integral form (running
/// sum) and the flow form (window) alike, without ever differencing a noisy product.

/// Increments of the integral of `rate(k)` over time; `increments` has samples - 1 entries.
template <typename Rate>
void IntegrateOverTime(const Stretch& stretch, Rate rate, std::span<double> increments) {
  double left = rate(0);
  for (int k = 0; k + 1 < stretch.samples; ++k) {
    const double right = rate(k + 1);
    increments[k] = 0.5 * stretch.period * (left + right);
    left = right;
  }
}

/// Increments of a quantity that needs no integration: level(k + 1) - level(k).
template <typename Level>
void Differences(const Stretch& stretch, Level level, std::span<double> increments) {
  double left = level(0);
  for (int k = 0; k + 1 < stretch.samples; ++k) {
    const double right = level(k + 1);
    increments[k] = right - left;
    left = right;
  }
}

/// Increments of the integral of `weight(k)` over the change of `level(k)`.
template <typename Weight, typename Level>
void IntegrateOver(const Stretch& stretch, Weight weight, Level level, std::span<double> increments) {
  double left_weight = weight(0), left = level(0);
  for (int k = 0; k + 1 < stretch.samples; ++k) {
    const double right_weight = weight(k + 1), right = level(k + 1);
    increments[k] = 0.5 * (left_weight + right_weight) * (right - left);
    left_weight = right_weight;
    left = right;
  }
}

}  // namespace hydroscope
