#pragma once

#include <memory>
#include <optional>

#include "core/told.h"
#include "replay/log_reader.h"

namespace hydroscope {

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
