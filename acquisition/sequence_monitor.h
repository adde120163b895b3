#pragma once

#include <cstdint>
#include <map>
#include <optional>

namespace hydroscope {

/// Follows the row numbers of one session: what is missing, what comes twice, what comes late. Constant memory.
class SequenceMonitor {
 public:
  struct Verdict {
    std::uint64_t skip = 0;     ///< leading rows that came before; all of them: nothing is new
    std::uint64_t missing = 0;  ///< rows between the newest row so far and this batch
    bool reordered = false;     ///< fills (part of) a hole: the rows had been counted as lost
  };

  /// Rows `first` ... `first + rows - 1` have come; `rows` > 0 and first + rows does not overflow.
  Verdict Receive(std::uint64_t first, std::uint64_t rows);

  /// The count goes on elsewhere; what it had lost before stays lost.
  void GoOnAt(std::uint64_t sequence) {
    next_ = sequence;
    holes_.clear();
  }

  /// The row was counted as lost, and has not come since.
  bool Lacks(std::uint64_t row) const;
  /// Row behind the newest one so far; nullopt before the first.
  std::optional<std::uint64_t> next() const { return begun_ ? std::optional(next_) : std::nullopt; }
  /// Rows lost so far; one that comes late after all is taken off again.
  std::int64_t lost() const { return lost_; }
  std::int64_t duplicates() const { return duplicates_; }
  std::int64_t reordered() const { return reordered_; }

 private:
  static constexpr std::size_t kHolesKept = 64;

  bool begun_ = false;
  std::uint64_t next_ = 0;
  std::map<std::uint64_t, std::uint64_t> holes_;  ///< first missing row -> row behind the last missing one
  std::int64_t lost_ = 0, duplicates_ = 0, reordered_ = 0;
};

}  // namespace hydroscope
