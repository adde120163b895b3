#pragma once

#include <string>
#include <vector>

#include "core/records/sample_block.h"
#include "core/result.h"
#include "models/machine.h"
#include "replay/log_layout.h"
#include "replay/log_reader.h"

namespace hydroscope {

/// SI value = raw * scale + offset.
struct Linear {
  double scale = 1.0;
  double offset = 0.0;
  bool IsIdentity() const { return scale == 1.0 && offset == 0.0; }
};

/// Which column of a log feeds which signal of a machine, and how it becomes SI.
struct ColumnPlan {
  static constexpr int kAbsent = -1;
  /// Per signal: column index, kAbsent for an optional signal the log does not have.
  std::vector<int> column;
  std::vector<Linear> to_si;  ///< per signal
  int time = kAbsent;         ///< column index; kAbsent: rows are equally spaced
  double time_scale = 1.0;    ///< s per unit of the time column
};

/// Maps the machine's signals onto the columns of a log. Errors: a required column is missing (lists the columns found,
/// suggests the nearest), an unknown unit, a unit row that contradicts the machine file, no time column and no sample
/// period. Optional columns that are absent and names that occur twice become findings,
/// the latter LogCounters::twins as well.
Result<ColumnPlan> PlanColumns(const LogLayout& layout, const Machine& machine, const std::string& origin,
                               LogCounters& counters);

/// "2 columns are called 'p_A' (2, 9): column 2 is read; ..." of a name that means several columns of the log; "" of any other.
Told TwinsText(const LogLayout& layout, const std::string& column);

/// Converts rows [0, rows) of every signal to SI in place.
void ConvertToSi(const ColumnPlan& plan, std::size_t rows, SampleBlock& block);

/// Adds a finding while there are fewer than 100.
void AddFinding(LogCounters& counters, LogFinding finding);

/// Index of a flag in LogCounters::flagged.
int FlagBit(Quality flag);

}  // namespace hydroscope
