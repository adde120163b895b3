#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/records/quality.h"
#include "core/result.h"
#include "storage/blobs/raw_codec.h"

namespace hydroscope {

/// Consecutive rows of the raw window as the database keeps them.
struct RawChunk {
  double first = 0, last = 0;  ///< s, of its rows
  std::int64_t rows = 0;
  std::size_t signals = 0;
  std::vector<std::uint8_t> samples, flags;  ///< PackColumns; no flags: all values are good

  std::int64_t bytes() const { return static_cast<std::int64_t>(samples.size() + flags.size()); }
};

/// Rows with time > `after` (s) as chunks of up to 1000. `values` and `flags` are [signal][row], as many rows
/// as `time` has; no flags: all are good. Error: the time does not increase.
Result<std::vector<RawChunk>> PackRaw(const std::vector<double>& time,
                                      const std::vector<std::vector<double>>& values,
                                      const std::vector<std::vector<Quality>>& flags, double after,
                                      ColumnPacker& packer);

}  // namespace hydroscope
