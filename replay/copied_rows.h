#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/constants.h"
#include "core/records/sample_block.h"
#include "core/told.h"
#include "replay/log_reader.h"

namespace hydroscope {

/// Of rows that repeat the stamp before: where more than this share has its readings too, a logger wrote them twice; where fewer have,
/// stamps are coarser than rows.
inline constexpr double kMostlyCopies = 0.5;

/// The row before the present one.
class RowBefore {
 public:
  struct Likeness {
    bool stamp = false;
    bool copy = false;  ///< stamp and all readings
  };
  /// What a row of `block` has of the row before; then it is that row.
  Likeness Compare(const SampleBlock& block, std::size_t row);

 private:
  double time_ = kNaN;  ///< s
  std::vector<double> values_;
};

/// Rows that a logger wrote twice: time stamp and readings of the row before once more, which are no rows of their own.
struct CopiedRows {
  double period = 0;  ///< s between the others
  Told why;           ///< how often, and that they are left out
};

/// Looks at the first rows of a log. Nothing if none is a copy, or if most rows that repeat a stamp have readings of their own:
/// then stamps are coarse.
std::optional<CopiedRows> FindCopiedRows(const SampleBlock& head);

/// `reader` without copies, and flags of time that follow from the other rows.
std::unique_ptr<LogReader> WithoutCopiedRows(std::unique_ptr<LogReader> reader, const CopiedRows& copied);

}  // namespace hydroscope
