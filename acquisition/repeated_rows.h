#pragma once

#include <cstdint>
#include <vector>

#include "core/records/sample_block.h"

namespace hydroscope {

/// Finds rows that a log holds again under other time stamps: a buffer that was written twice, files that overlap. They are
/// no further evidence. Rows count as copies where 32 and more follow one another as rows before did, every value the
/// very same, of which two at least are of channels with noise: chance does not make them, and a machine without noise that
/// repeats its cycle is left alone. The last 31 rows are held back: what comes shows whether they are copies. Remembers the last
/// quarter of a million rows. Does not depend on how rows are cut into blocks.
class RepeatedRows {
 public:
  explicit RepeatedRows(std::size_t signals);
  /// Adds kDuplicate to all values of such rows. Afterwards `block` holds the rows to be processed.
  void Inspect(SampleBlock& block);
  /// Fills `block` with the rows held back.
  void Flush(SampleBlock& block);
  std::int64_t copies() const { return copies_; }  ///< rows flagged so far

 private:
  /// What tells noise from motion: how often a channel turns back.
  struct Channel {
    double last = 0, step = 0;  ///< SI
    std::int64_t changes = 0, reversals = 0;
  };
  bool Changes(const SampleBlock& block, std::size_t row);
  void Compare(std::uint64_t hash);
  bool IsAt(std::int64_t row, std::uint64_t hash) const;

  std::vector<Channel> channels_;
  std::vector<std::uint64_t> hashes_;  ///< of the last rows
  std::vector<std::uint32_t> latest_;  ///< last bits of a row by the last ones of its hash; of none: 0
  std::int64_t row_ = 0;               ///< of the log
  std::int64_t distance_ = 0;          ///< rows back to those that are repeated; 0: none are
  std::int64_t copies_ = 0;
  std::int64_t same_ = 0;  ///< rows in a row that were the same at that distance
  SampleBlock held_;
};

}  // namespace hydroscope
