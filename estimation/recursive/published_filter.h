#pragma once

#include <array>
#include <vector>

namespace hydroscope {

/// The filters of the press paper on one channel: moving average over `average` samples (eq. 26) and, on the averaged
/// signal, the symmetrical derivative over `derivative` samples (eq. 27 with its missing 1/T_s put in):
///   dy/dt(k) = sum_{i=1..m} (y(k+i) - y(k-i)) / (m (m + 1) T_s),  m = (derivative - 1) / 2.
/// Widths are made odd; 0 or 1 means no averaging, and the derivative is at least over 3 samples.
/// Value and derivative refer to the same sample, `Delay()` samples ago.
class PublishedFilter {
 public:
  PublishedFilter(int average, int derivative, double period);

  /// Takes a sample in; true once value() and derivative() are valid.
  bool Push(double sample);
  void Reset();
  double value() const { return averaged_[Slot(half_derivative_)]; }
  double derivative() const;
  int Delay() const { return half_average_ + half_derivative_; }

 private:
  /// Slot of the averaged sample `back` samples before the newest.
  int Slot(int back) const {
    const int size = static_cast<int>(averaged_.size());
    return (newest_ - back + size) % size;
  }

  int half_average_, half_derivative_;
  double period_;
  std::vector<double> raw_, averaged_;
  int raw_next_ = 0, raw_count_ = 0, newest_ = -1, averaged_count_ = 0;
};

}  // namespace hydroscope
