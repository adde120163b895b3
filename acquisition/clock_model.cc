#include "acquisition/clock_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hydroscope {

void ClockModel::Observe(std::int64_t sender, std::int64_t host) {
  if (count_ == 0) {
    reference_ = sender;
    reference_offset_ = host - sender;
    window_end_ = kWindow;
    minima_[0] = {};
    count_ = 1;
    at_ = 0;
    newest_ = sender;
    return Fit();
  }
  newest_ = std::max(newest_, sender);
  const Minimum now = {sender - reference_, host - sender - reference_offset_};
  if (now.sender >= window_end_) {
    window_end_ = now.sender + kWindow;
    at_ = (at_ + 1) % kWindows;
    count_ = std::min(count_ + 1, kWindows);
    minima_[at_] = now;
  } else if (now.offset < minima_[at_].offset) {
    minima_[at_] = now;
  } else {
    return;
  }
  Fit();
}

void ClockModel::Fit() {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  if (count_ >= kWindowsForDrift) {
    const double origin = static_cast<double>(minima_[at_].sender);
    for (std::size_t i = 0; i < count_; ++i) {
      const double dx = static_cast<double>(minima_[i].sender) - origin;
      const double dy = static_cast<double>(minima_[i].offset);
      n += 1, x += dx, y += dy, xx += dx * dx, xy += dx * dy;
    }
    const double spread = n * xx - x * x;
    drift_ = spread > 0 ? std::clamp((n * xy - x * y) / spread, -kMostDrift, kMostDrift) : 0.0;
  }
  base_ = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count_; ++i)
    base_ = std::min(
        base_, static_cast<double>(minima_[i].offset) - drift_ * static_cast<double>(minima_[i].sender));
}

std::int64_t ClockModel::ToHost(std::int64_t sender) const {
  if (count_ == 0) return sender;
  const double since = static_cast<double>(sender - reference_);
  return sender + reference_offset_ + std::llround(base_ + drift_ * since);
}

}  // namespace hydroscope
