#pragma once

#include <cstddef>
#include <vector>

#include "core/records/quality.h"

namespace hydroscope {

/// Consecutive rows of one machine's signals, column-wise, in SI units. The unit of work of the pipeline: log
/// readers fill blocks of about a thousand rows, the live service smaller ones; results do not depend on how
/// rows are cut into blocks.
struct SampleBlock {
  std::vector<double> time;                   ///< s, one per row
  std::vector<std::vector<double>> signal;    ///< [signal index of the machine file][row], SI
  std::vector<std::vector<Quality>> quality;  ///< same shape as `signal`

  std::size_t rows() const { return time.size(); }

  /// Makes room for `signals` channels of `rows` rows; keeps memory already allocated.
  void Resize(std::size_t signals, std::size_t rows) {
    time.resize(rows);
    signal.resize(signals);
    quality.resize(signals);
    for (auto& column : signal) column.resize(rows);
    for (auto& column : quality) column.resize(rows);
  }
};

}  // namespace hydroscope
