#pragma once

#include <algorithm>
#include <cmath>

#include "models/die_cushion.h"

namespace hydroscope::effects {

/// A channel `shift` seconds later (negative: earlier), by the line between samples; beyond the stretch its
/// end value. For what is integrated over time, or smoothed already: the line takes white noise out of
/// samples, which would spoil the estimate of the noise of a level.
class ShiftedSignal {
 public:
  ShiftedSignal(const Stretch& stretch, int channel, double shift)
      : x_(stretch[channel]),
        last_(stretch.samples - 1),
        whole_(static_cast<int>(std::floor(shift / stretch.period))),
        fraction_(shift / stretch.period - whole_) {}

  double operator()(int k) const {
    const double here = x_[std::clamp(k + whole_, 0, last_)], next = x_[std::clamp(k + whole_ + 1, 0, last_)];
    return here + fraction_ * (next - here);
  }

 private:
  const double* x_;
  int last_, whole_;
  double fraction_;
};

}  // namespace hydroscope::effects
