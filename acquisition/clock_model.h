#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace hydroscope {

/// Maps a sender's clock to the host's monotonic clock. A message can only be delayed, never early, so the
/// smallest difference (received - sent) of each second lies near the true offset: a minimum-delay filter
/// (Moon, Skelly, Towsley 1999; RFC 5905, sec. 10). A line through the minima of the last minute gives the
/// drift, the lowest of them the offset. What remains unseen is the shortest way itself (below 1 ms in a
/// plant network), which no one-way exchange can tell.
class ClockModel {
 public:
  /// A message whose last sample was taken at `sender` (ns, the sender's clock) arrived at `host` (ns,
  /// monotonic). `sender` must not go back by more than the window.
  void Observe(std::int64_t sender, std::int64_t host);
  void Reset() { *this = ClockModel(); }

  bool known() const { return count_ > 0; }
  /// Host time (ns, monotonic) of a moment of the sender's clock; identity while nothing is known.
  std::int64_t ToHost(std::int64_t sender) const;
  /// ns that the host's clock was ahead of the sender's when the newest message came.
  std::int64_t offset() const { return ToHost(newest_) - newest_; }
  /// Host seconds per sender second, minus 1; 0 until 16 s are known.
  double drift() const { return drift_; }

 private:
  static constexpr std::size_t kWindows = 64;
  static constexpr std::size_t kWindowsForDrift = 16;
  static constexpr std::int64_t kWindow = 1'000'000'000;  ///< ns
  static constexpr double kMostDrift = 500e-6;

  struct Minimum {
    std::int64_t sender = 0;  ///< ns, since reference_
    std::int64_t offset = 0;  ///< ns, since reference_offset_
  };
  void Fit();

  std::int64_t reference_ = 0, reference_offset_ = 0, newest_ = 0;
  std::array<Minimum, kWindows> minima_{};
  std::size_t count_ = 0, at_ = 0;
  std::int64_t window_end_ = 0;
  double base_ = 0, drift_ = 0;  ///< offset = reference_offset_ + base_ + drift_ * (sender - reference_)
};

}  // namespace hydroscope
