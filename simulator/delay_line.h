#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace hydroscope {

/// A signal late by a fixed time: values enter once per step, and come out interpolated linearly between steps.
class DelayLine {
 public:
  /// `delay` s >= 0, `step` s; before the first value the line holds that value.
  DelayLine(double delay, double step)
      : steps_(delay / step), ring_(static_cast<std::size_t>(std::ceil(delay / step)) + 2) {}

  void Push(double value) {
    if (empty_) std::fill(ring_.begin(), ring_.end(), value);
    empty_ = false;
    newest_ = newest_ + 1 == ring_.size() ? 0 : newest_ + 1;
    ring_[newest_] = value;
  }
  double Read() const {
    const auto whole = static_cast<std::size_t>(steps_);
    const double fraction = steps_ - static_cast<double>(whole);
    return Ago(whole) + fraction * (Ago(whole + 1) - Ago(whole));
  }

 private:
  double Ago(std::size_t steps) const {
    return ring_[(newest_ + ring_.size() - steps % ring_.size()) % ring_.size()];
  }

  double steps_;
  std::vector<double> ring_;
  std::size_t newest_ = 0;
  bool empty_ = true;
};

}  // namespace hydroscope
