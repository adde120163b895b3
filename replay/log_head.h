#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "models/machine.h"
#include "replay/log_layout.h"

namespace hydroscope {

/// Texts in a column, other than those that say that there is no value.
struct LogWords {
  static constexpr std::size_t kMost = 64;  ///< different ones that are kept
  std::vector<std::string> seen;            ///< in order of appearance
  std::vector<int> of_row;                  ///< index in `seen`; -1: none, or one beyond kMost
  std::size_t rows = 0;                     ///< that hold a text
};

/// The beginning of a log with all its columns, to look at before there is a machine file.
struct LogHead {
  LogLayout layout;                          ///< of a MAT file only names and units mean something
  std::vector<std::vector<double>> columns;  ///< [column of layout.names][row]; NaN where there is no number.
                                             ///< Dates and times of day in s (see ParseDateTime).
  std::vector<bool> is_date;                 ///< the column holds dates or times of day as text
  bool mat = false;                          ///< a MAT file
  std::vector<LogWords> words;               ///< [column]: what stands there in place of numbers

  std::size_t rows() const { return columns.empty() ? 0 : columns.front().size(); }
};

/// Reads layout and the first `rows` rows of a log (CSV, .gz or MAT). Rows with too few fields are left out.
Result<LogHead> ReadLogHead(const std::string& path, std::size_t rows = 5000, const LogFormat& hints = {});

}  // namespace hydroscope
