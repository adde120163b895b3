#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/records/quality.h"
#include "core/result.h"

namespace hydroscope {

/// Columns of equal length as compressed bytes; every bit comes back, NaN included. A column that is a
/// multiple of one step (an analogue-to-digital converter's) becomes whole numbers, another one the bit
/// patterns of its values; both are differenced up to twice, whichever leaves the smallest numbers, and
/// deflated. Format: docs/database.md.
std::vector<std::uint8_t> PackColumns(const std::vector<std::span<const double>>& columns);
/// The same for quality flags.
std::vector<std::uint8_t> PackColumns(const std::vector<std::span<const Quality>>& columns);

/// PackColumns again and again: the tables of the compressor take longer to allocate than a short column to compress.
class ColumnPacker {
 public:
  ColumnPacker();
  ~ColumnPacker();
  std::vector<std::uint8_t> Pack(const std::vector<std::span<const double>>& columns);
  std::vector<std::uint8_t> Pack(const std::vector<std::span<const Quality>>& columns);

 private:
  class Deflater;
  std::unique_ptr<Deflater> deflater_;
};

/// `columns` x `rows` values back, also of what version 1 packed; the error tells what is wrong with the bytes.
Result<std::vector<std::vector<double>>> UnpackColumns(std::span<const std::uint8_t> bytes,
                                                       std::size_t columns, std::size_t rows);
Result<std::vector<std::vector<Quality>>> UnpackFlags(std::span<const std::uint8_t> bytes,
                                                      std::size_t columns, std::size_t rows);

}  // namespace hydroscope
