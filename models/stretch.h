#pragma once

#include <algorithm>
#include <span>
#include <vector>

namespace hydroscope {

/// A run of consecutive good samples on the uniform grid, channel by channel, in SI. Channels are the model's own
/// (for the die cushion: `DieCushionChannel`), measured ones first, then those the model derives from them.
/// Equations are taken on samples 0 ... samples - 1; what was measured right before and after them is there too, for
/// rates and shifted signals, which look beyond the ends.
struct Stretch {
  int samples = 0;
  int before = 0, after = 0;  ///< samples known beyond the ends, good or not gated but contiguous
  double period = 0.0;        ///< s between samples
  double begin = 0.0;         ///< s, time of sample 0, from an origin that all stretches of a recording share
  bool continues = false;     ///< sample 0 is the last sample of the stretch before
  int log = 0;                ///< number of the log it is from, where several are taken together
  bool scattered = false;     ///< samples from here and there, for their noise: nothing moves between them
  bool derived = false;       ///< the derived channels are filled, for GramsOf
  std::vector<std::vector<double>> channel;  ///< [channel][before + sample]

  /// Samples -before ... samples + after - 1 of a channel.
  const double* operator[](int index) const {
    return channel[static_cast<std::size_t>(index)].data() + before;
  }
  double* operator[](int index) { return channel[static_cast<std::size_t>(index)].data() + before; }
};

/// The gated samples of one stroke, as the pipeline cut them.
using StrokeStretches = std::vector<Stretch>;

/// Every column of a balance is a Stieltjes integral of products of channels: increment k of a column is the
/// trapezoidal value of a * db between samples k and k + 1. From the increments follow the integral form (running
/// sum) and the flow form (window) alike, without ever differencing a noisy product.

/// The functions below evaluate in chunks on the stack, so that the compiler can vectorise both the evaluation and the
/// differences; every sample is evaluated once.
inline constexpr int kChunk = 64;

/// Increments of the integral of `rate(k)` over time; `increments` has samples - 1 entries.
template <typename Rate>
void IntegrateOverTime(const Stretch& stretch, Rate rate, std::span<double> increments) {
  const double half = 0.5 * stretch.period;
  double value[kChunk + 1];
  value[0] = rate(0);
  for (int first = 0; first + 1 < stretch.samples; first += kChunk) {
    const int count = std::min(kChunk, stretch.samples - 1 - first);
    for (int k = 0; k < count; ++k) value[k + 1] = rate(first + k + 1);
    double* out = increments.data() + first;
    for (int k = 0; k < count; ++k) out[k] = half * (value[k] + value[k + 1]);
    value[0] = value[count];
  }
}

/// Increments of a quantity that needs no integration: level(k + 1) - level(k).
template <typename Level>
void Differences(const Stretch& stretch, Level level, std::span<double> increments) {
  double value[kChunk + 1];
  value[0] = level(0);
  for (int first = 0; first + 1 < stretch.samples; first += kChunk) {
    const int count = std::min(kChunk, stretch.samples - 1 - first);
    for (int k = 0; k < count; ++k) value[k + 1] = level(first + k + 1);
    double* out = increments.data() + first;
    for (int k = 0; k < count; ++k) out[k] = value[k + 1] - value[k];
    value[0] = value[count];
  }
}

/// Increments of the integral of `weight(k)` over the change of `level(k)`.
template <typename Weight, typename Level>
void IntegrateOver(const Stretch& stretch, Weight weight, Level level, std::span<double> increments) {
  double weights[kChunk + 1], value[kChunk + 1];
  weights[0] = weight(0);
  value[0] = level(0);
  for (int first = 0; first + 1 < stretch.samples; first += kChunk) {
    const int count = std::min(kChunk, stretch.samples - 1 - first);
    for (int k = 0; k < count; ++k) weights[k + 1] = weight(first + k + 1);
    for (int k = 0; k < count; ++k) value[k + 1] = level(first + k + 1);
    double* out = increments.data() + first;
    for (int k = 0; k < count; ++k) out[k] = 0.5 * (weights[k] + weights[k + 1]) * (value[k + 1] - value[k]);
    weights[0] = weights[count];
    value[0] = value[count];
  }
}

}  // namespace hydroscope
