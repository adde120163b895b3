#include "estimation/recursive/published_filter.h"

#include <algorithm>

namespace hydroscope {

PublishedFilter::PublishedFilter(int average, int derivative, double period)
    : half_average_(std::max(0, average / 2)),
      half_derivative_(std::max(1, derivative / 2)),
      period_(period) {
  raw_.assign(2 * half_average_ + 1, 0.0);
  averaged_.assign(2 * half_derivative_ + 1, 0.0);
}

void PublishedFilter::Reset() { raw_next_ = raw_count_ = averaged_count_ = 0; }

bool PublishedFilter::Push(double sample) {
  raw_[raw_next_] = sample;
  raw_next_ = (raw_next_ + 1) % static_cast<int>(raw_.size());
  if (++raw_count_ < static_cast<int>(raw_.size())) return false;
  double sum = 0;
  for (double x : raw_) sum += x;
  newest_ = (newest_ + 1) % static_cast<int>(averaged_.size());
  averaged_[newest_] = sum / static_cast<double>(raw_.size());
  return ++averaged_count_ >= static_cast<int>(averaged_.size());
}

double PublishedFilter::derivative() const {
  const int m = half_derivative_;
  double sum = 0;
  for (int i = 1; i <= m; ++i) sum += averaged_[Slot(m - i)] - averaged_[Slot(m + i)];
  return sum / (m * (m + 1) * period_);
}

}  // namespace hydroscope
