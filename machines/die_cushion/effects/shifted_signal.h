#pragma once

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

#include "machines/die_cushion/balance.h"
#include "models/effect.h"

namespace hydroscope::effects {

/// What the delays of all signals share: one time, at once the size and the shape of the law.
inline Effect LateSignal() {
  Effect e;
  e.parameter = "t_d";
  e.unit = "s";
  e.max = 0.05;
  e.typical = 0.002;
  e.nonlinear = {{"delay", "s", 0.0002, 0.05}};
  e.implied = [](const ShapeContext& c) { return c.size; };
  e.grid = {{0.006}};
  return e;
}

/// A channel `shift` seconds later (negative: earlier), by the line between samples; beyond what is known of
/// it its end value. For what is integrated over time, or smoothed already: the line takes white noise out of
/// samples, which would spoil the estimate of the noise of a level.
class ShiftedSignal {
 public:
  ShiftedSignal(const Stretch& stretch, int channel, double shift)
      : x_(stretch[channel]), fraction_(shift / stretch.period) {
    const int whole = static_cast<int>(std::floor(fraction_));
    fraction_ -= whole;
    const int first = -stretch.before, last = stretch.samples + stretch.after - 1;
    if (whole >= first && whole + stretch.samples <= last) {
      x_ += whole;
      return;
    }
    held_.resize(static_cast<std::size_t>(stretch.samples) + 1);
    for (int k = 0; k <= stretch.samples; ++k) held_[k] = x_[std::clamp(k + whole, first, last)];
    x_ = held_.data();
  }
  ShiftedSignal(const ShiftedSignal&) = delete;
  ShiftedSignal& operator=(const ShiftedSignal&) = delete;

  double operator()(int k) const { return x_[k] + fraction_ * (x_[k + 1] - x_[k]); }

 private:
  const double* x_;           ///< shifted by whole samples
  double fraction_;           ///< of a sample, beyond the whole ones
  std::vector<double> held_;  ///< in place of the channel's own samples, if the shift leads beyond its ends
};

/// Mean of a smooth channel between now and `shift` seconds later (negative: earlier), by Simpson's rule: of
/// a rate, the change over that time per second.
class MeanOverShift {
 public:
  MeanOverShift(const Stretch& stretch, int channel, double shift)
      : now_(stretch[channel]), half_way_(stretch, channel, 0.5 * shift), then_(stretch, channel, shift) {}

  double operator()(int k) const { return (now_[k] + 4 * half_way_(k) + then_(k)) * (1.0 / 6.0); }

 private:
  const double* now_;
  ShiftedSignal half_way_, then_;
};

/// Moves channels by the nearest whole number of samples: sample k becomes what was measured `shift` seconds
/// later (negative: earlier); beyond what is known, its end value. For levels too, whose noise stays white.
inline void ShiftChannels(Stretch& stretch, std::initializer_list<int> channels, double shift) {
  const std::ptrdiff_t known = stretch.before + stretch.samples + stretch.after;
  const auto by = std::clamp<std::ptrdiff_t>(std::lround(shift / stretch.period), 1 - known, known - 1);
  for (const int channel : channels) {
    double *const first = stretch[channel] - stretch.before, *const last = first + known;
    if (by > 0) std::fill(std::move(first + by, last, first), last, last[-1]);
    if (by < 0) std::fill(first, std::move_backward(first, last + by, last), first[0]);
  }
}

}  // namespace hydroscope::effects
