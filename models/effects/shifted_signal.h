#pragma once

#include <algorithm>
#include <cmath>

#include "models/die_cushion.h"

namespace hydroscope::effects {

/// A channel `shift` seconds later (negative: earlier), by the line between samples; beyond what is known of it
/// its end value. For what is integrated over time, or smoothed already: the line takes white noise out of
/// samples, which would spoil the estimate of the noise of a level.
class ShiftedSignal {
 public:
  ShiftedSignal(const Stretch& stretch, int channel, double shift)
      : x_(stretch[channel]),
        first_(-stretch.before),
        last_(stretch.samples + stretch.after - 1),
        whole_(static_cast<int>(std::floor(shift / stretch.period))),
        fraction_(shift / stretch.period - whole_) {}

  double operator()(int k) const {
    const double here = x_[std::clamp(k + whole_, first_, last_)], next = x_[std::clamp(k + whole_ + 1, first_, last_)];
    return here + fraction_ * (next - here);
  }

 private:
  const double* x_;
  int first_, last_, whole_;
  double fraction_;
};

/// Mean of a smooth channel between now and `shift` seconds later (negative: earlier), by Simpson's rule: of a rate, the
/// change over that time per second.
class MeanOverShift {
 public:
  MeanOverShift(const Stretch& stretch, int channel, double shift)
      : now_(stretch[channel]), half_way_(stretch, channel, 0.5 * shift), then_(stretch, channel, shift) {}

  double operator()(int k) const { return (now_[k] + 4 * half_way_(k) + then_(k)) * (1.0 / 6.0); }

 private:
  const double* now_;
  ShiftedSignal half_way_, then_;
};

}  // namespace hydroscope::effects
