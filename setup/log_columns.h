#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "replay/log_head.h"

namespace hydroscope {

/// One column of the beginning of a log as numbers, and what they look like.
struct LogColumn {
  std::string name;           ///< header text, or the number of the column
  std::string reference;      ///< what a machine file writes to mean this column: its name, or its number
  std::string unit;           ///< unit text of the header, "" if none
  bool unit_chosen = false;   ///< by a person, in place of the header's
  std::vector<double> value;  ///< raw, one per row; NaN where there is no number
  bool date = false;          ///< dates or times of day, read as s
  double low = 0, high = 0;   ///< 1 % and 99 % quantile; NaN without numbers
  double step = 0;            ///< median difference between rows; of stamps coarser than these the mean
  bool rising = false;        ///< every row above the one before
  double roughness = 0;  ///< standard deviation of the difference between rows / of the values; 0 = constant
  double repeated = 0;   ///< share of rows with the very same value as the row before

  bool numeric() const { return low == low; }
  double span() const { return high - low; }
};

/// The beginning of a log, described column by column.
struct LogColumns {
  std::string path;
  LogLayout layout;
  std::vector<LogColumn> columns;
  std::size_t rows = 0;
};

/// Rows that are looked at.
inline constexpr std::size_t kRowsLookedAt = 60'000;

/// Describes the columns of the first rows of a log. Errors as ReadLogHead.
Result<LogColumns> ReadLogColumns(const std::string& path);

}  // namespace hydroscope
