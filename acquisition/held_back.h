#pragma once

#include <cstddef>

#include "core/records/sample_block.h"

namespace hydroscope {

/// Puts the rows of `back` behind those of `front`.
inline void AppendRows(const SampleBlock& back, SampleBlock& front) {
  front.signal.resize(back.signal.size());
  front.quality.resize(back.quality.size());
  front.time.insert(front.time.end(), back.time.begin(), back.time.end());
  for (std::size_t c = 0; c < back.signal.size(); ++c) {
    front.signal[c].insert(front.signal[c].end(), back.signal[c].begin(), back.signal[c].end());
    front.quality[c].insert(front.quality[c].end(), back.quality[c].begin(), back.quality[c].end());
  }
}

/// Takes the last `rows` rows off `block`.
inline SampleBlock TakeLastRows(SampleBlock& block, std::size_t rows) {
  const auto at = static_cast<std::ptrdiff_t>(block.rows() - rows);
  SampleBlock end;
  end.time.assign(block.time.begin() + at, block.time.end());
  for (const auto& column : block.signal) end.signal.emplace_back(column.begin() + at, column.end());
  for (const auto& column : block.quality) end.quality.emplace_back(column.begin() + at, column.end());
  block.Resize(block.signal.size(), block.rows() - rows);
  return end;
}

}  // namespace hydroscope
