#include "storage/raw_codec.h"

#include <zlib.h>

#include <cstring>

namespace hydroscope {

std::vector<std::uint8_t> PackColumns(const std::vector<std::span<const double>>& columns) {
  const std::size_t rows = columns.empty() ? 0 : columns.front().size();
  std::vector<std::uint8_t> shuffled(columns.size() * rows * sizeof(double));
  std::uint8_t* column_start = shuffled.data();
  for (const auto& column : columns) {
    for (std::size_t row = 0; row < rows; ++row) {
      std::uint8_t bytes[sizeof(double)];
      std::memcpy(bytes, &column[row], sizeof(double));
      for (std::size_t byte = 0; byte < sizeof(double); ++byte) column_start[byte * rows + row] = bytes[byte];
    }
    column_start += rows * sizeof(double);
  }
  uLongf size = compressBound(shuffled.size());
  std::vector<std::uint8_t> packed(size);
  compress2(packed.data(), &size, shuffled.data(), shuffled.size(),
            1);  // cannot fail into compressBound bytes
  packed.resize(size);
  return packed;
}

Result<std::vector<std::vector<double>>> UnpackColumns(std::span<const std::uint8_t> bytes,
                                                       std::size_t columns, std::size_t rows) {
  std::vector<std::uint8_t> shuffled(columns * rows * sizeof(double));
  uLongf size = shuffled.size();
  const int code = uncompress(shuffled.data(), &size, bytes.data(), bytes.size());
  if (code != Z_OK || size != shuffled.size())
    return BadInput("damaged: {} bytes do not unpack to {} columns of {} rows", bytes.size(), columns, rows);
  std::vector<std::vector<double>> values(columns, std::vector<double>(rows));
  const std::uint8_t* column_start = shuffled.data();
  for (auto& column : values) {
    for (std::size_t row = 0; row < rows; ++row) {
      std::uint8_t value[sizeof(double)];
      for (std::size_t byte = 0; byte < sizeof(double); ++byte) value[byte] = column_start[byte * rows + row];
      std::memcpy(&column[row], value, sizeof(double));
    }
    column_start += rows * sizeof(double);
  }
  return values;
}

}  // namespace hydroscope
