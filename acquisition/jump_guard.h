#pragma once

#include <cstdint>

namespace hydroscope {

/// A count that is somewhere else all at once is believed only when it goes on there: one damaged or forged
/// batch changes nothing.
class JumpGuard {
 public:
  /// The count is where it was expected.
  void Forget() { batches_ = 0; }
  /// Rows `first` ... `first + rows - 1` lie where nobody expects them, at `now` (ns, monotonic). True: so did
  /// the batches before, each right behind the other, for long enough.
  bool GoesOn(std::uint64_t first, std::uint64_t rows, std::int64_t now) {
    batches_ = batches_ > 0 && first == next_ ? batches_ + 1 : 1;
    if (batches_ == 1) since_ = now;
    next_ = first + rows;
    return batches_ >= kBatches && now - since_ >= kTime;
  }

 private:
  static constexpr int kBatches = 3;
  static constexpr std::int64_t kTime = 1'000'000'000;  ///< ns

  int batches_ = 0;
  std::uint64_t next_ = 0;
  std::int64_t since_ = 0;
};

}  // namespace hydroscope
