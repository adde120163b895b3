#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/records/sample_block.h"
#include "core/result.h"
#include "core/told.h"
#include "models/machine.h"

namespace hydroscope {

/// One thing wrong with a log that did not stop the reading, for the report of what was skipped and why.
struct LogFinding {
  std::int64_t line = 0;  ///< 1-based line (CSV) or row (MAT)
  std::string column;     ///< "" if the whole row
  std::string found;      ///< the text found
  std::string expected;
};

struct LogCounters {
  std::int64_t rows = 0;           ///< rows delivered
  std::int64_t rejected_rows = 0;  ///< rows that could not be delivered at all (torn, wrong field count)
  std::array<std::int64_t, 16> flagged{};  ///< values per quality flag (bit number), set by the reader
  std::vector<LogFinding> findings;        ///< the first 100
  /// Why rows have times other than their stamps, are fewer than the log has, or readings other than it has; "" if none of these.
  Told time_base;
  /// Names of the machine file that several columns have, which of these is read and how to choose another; "" if there are none.
  Told twins;
};

/// A stream of samples from a file of any size: memory does not grow with the file.
class LogReader {
 public:
  virtual ~LogReader() = default;
  /// Fills `block` with up to `max_rows` rows; 0 rows at the end of the log. An error when the file cannot be
  /// read further; rows delivered before stay valid.
  virtual Result<std::size_t> Read(SampleBlock& block, std::size_t max_rows) = 0;
  /// Share of the file read, 0...1.
  virtual double Progress() const = 0;
  /// Nominal time between rows, s.
  virtual double SamplePeriod() const = 0;
  virtual const LogCounters& counters() const = 0;
};

/// Opens a CSV (plain or .gz) or MAT (v4 to v7.3) log with the columns, units, scales and offsets of `machine`. Rows that a
/// logger repeats (replay/held_rows.h) or writes twice (replay/copied_rows.h) are left out, and rows whose stamps are coarse or
/// jitter get even times where they have them (replay/even_rows.h); signals that are new every few rows only are drawn straight in
/// between (replay/held_signals.h). Missing column: an error that lists the columns found and suggests the nearest.
Result<std::unique_ptr<LogReader>> OpenLog(const std::string& path, const Machine& machine);

}  // namespace hydroscope
