#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace hydroscope {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Rows of a log in a row, without a gap.
struct Episode {
  int log = 0;
  std::int64_t first_row = 0;  ///< of the log
  std::vector<double> time;    ///< s
  RowMatrix signal;            ///< row x signal of the machine, SI; an output that is no good reading is NaN
  /// Above 1, an even number: outputs have a reading at each so many rows, their mean since the reading before.
  int mean_rows = 1;
  /// Row x signal of the machine, SI: what of an output repeats with a shaft once to three times in a revolution, so that lines
  /// between the rows hold it. Empty: nothing is known of it.
  RowMatrix ripple = {};

  int rows() const { return static_cast<int>(time.size()); }
  /// At a row, or where readings are means the first from there on; NaN if there is none.
  double Reading(int row, int s) const {
    const int end = mean_rows > 1 ? std::min(rows(), row + mean_rows + 1) : row + 1;
    for (; row < end; ++row)
      if (std::isfinite(signal(row, s))) return signal(row, s);
    return std::numeric_limits<double>::quiet_NaN();
  }
  Episode Part(std::int64_t first, std::int64_t count) const {
    Episode part{log,
                 first_row + first,
                 {time.begin() + first, time.begin() + first + count},
                 signal.middleRows(first, count),
                 mean_rows};
    if (ripple.size() > 0) part.ripple = ripple.middleRows(first, count);
    return part;
  }
};

}  // namespace hydroscope
