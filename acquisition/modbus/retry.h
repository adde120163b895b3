#pragma once

#include <algorithm>
#include <cstdint>
#include <random>

namespace hydroscope {

/// Pauses between attempts: doubling from `first` to `limit`, each drawn between half of that and all of it,
/// so that many clients do not come back at once. The same seed gives the same pauses.
class Backoff {
 public:
  Backoff(double first, double limit, std::uint64_t seed)
      : first_(first), limit_(limit), next_(first), random_(seed) {}

  /// s to wait before the next attempt.
  double Next() {
    const double pause = next_ * (0.5 + 0.5 * static_cast<double>(random_() >> 11) * 0x1.0p-53);
    next_ = std::min(2 * next_, limit_);
    return pause;
  }
  void Reset() { next_ = first_; }

 private:
  double first_, limit_, next_;
  std::mt19937_64 random_;
};

}  // namespace hydroscope
