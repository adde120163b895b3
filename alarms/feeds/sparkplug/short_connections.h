#pragma once

#include <algorithm>
#include <cstdint>

namespace hydroscope {

/// Connections that the broker takes and soon ends, one after the other: another client has the same name, or may not do what
/// it does. From the third on the next one waits, and counts as one only when it has stood for a while. Times in ns, monotonic.
class ShortConnections {
 public:
  void Begun(std::int64_t now) { begun_ = now; }
  /// By the broker, not by us.
  void Ended(std::int64_t now) {
    ended_ = now;
    in_a_row_ = now - begun_ < kShort ? in_a_row_ + 1 : 0;
  }
  bool are_a_habit() const { return in_a_row_ >= kHabit; }
  bool MayBegin(std::int64_t now) const {
    return !are_a_habit() || now - ended_ >= std::min(in_a_row_ * kSecond, kLongestPause);
  }
  /// Whether the connection that stands may be told of.
  bool Stands(std::int64_t now) const { return !are_a_habit() || now - begun_ >= kProof; }

 private:
  static constexpr std::int64_t kSecond = 1'000'000'000;
  static constexpr std::int64_t kShort = 60 * kSecond, kLongestPause = 10 * kSecond, kProof = 3 * kSecond;
  static constexpr std::int64_t kHabit = 3;

  std::int64_t begun_ = 0, ended_ = 0, in_a_row_ = 0;
};

}  // namespace hydroscope
