#pragma once

#include <memory>
#include <optional>

#include "core/told.h"
#include "replay/log_reader.h"
#include "replay/stamp_line.h"

namespace hydroscope {

/// Rows that were sampled at even intervals, though their time stamps do not show it: stamps coarser than the rows (10 ms, a
/// whole second), or taken by a computer when it stored a row.
struct EvenRows : StampLine {
  Told why;  ///< what is wrong with the stamps, and what is taken in their place
};

/// Whether the stamps of a log's first rows are coarse or jitter.
bool MayBeEvenRows(const SampleBlock& head);

/// Reads a log to its end. Nothing if its stamps are as good as even times, if rows are not even, or if the log is too short to
/// tell, or longer than 5 million rows. Whether coarse stamps belong to even rows is told by their distances from a straight line, which are not beyond one step
/// of the clock; whether stamps that jitter do, by the signals: those of even rows are smoother over the rows than over the
/// stamps. Rows that are missing between even ones begin a new piece.
Result<std::optional<EvenRows>> FindEvenRows(LogReader& log);

/// `reader` with the times of `rows` in place of its stamps, and flags of time that follow from these.
std::unique_ptr<LogReader> WithEvenTimes(std::unique_ptr<LogReader> reader, EvenRows rows);

}  // namespace hydroscope
