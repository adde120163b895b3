#include "storage/raw_codec.h"

#include <zlib.h>

#include <cstring>

namespace hydroscope {
namespace {

template <typename T>
std::vector<std::uint8_t> Pack(const std::vector<std::span<const T>>& columns) {
  const std::size_t rows = columns.empty() ? 0 : columns.front().size();
  std::vector<std::uint8_t> shuffled(columns.size() * rows * sizeof(T));
  std::uint8_t* column_start = shuffled.data();
  for (const auto& column : columns) {
    for (std::size_t row = 0; row < rows; ++row) {
      std::uint8_t bytes[sizeof(T)];
      std::memcpy(bytes, &column[row], sizeof(T));
      for (std::size_t byte = 0; byte < sizeof(T); ++byte) column_start[byte * rows + row] = bytes[byte];
    }
    column_start += rows * sizeof(T);
  }
  uLongf size = compressBound(shuffled.size());
  std::vector<std::uint8_t> packed(size);
  compress2(packed.data(), &size, shuffled.data(), shuffled.size(),
            1);  // cannot fail into compressBound bytes
  packed.resize(size);
  return packed;
}

template <typename T>
Result<std::vector<std::vector<T>>> Unpack(std::span<const std::uint8_t> bytes, std::size_t columns,
                                           std::size_t rows) {
  std::vector<std::uint8_t> shuffled(columns * rows * sizeof(T));
  uLongf size = shuffled.size();
  const int code = uncompress(shuffled.data(), &size, bytes.data(), bytes.size());
  if (code != Z_OK || size != shuffled.size())
    return BadInput("damaged: {} bytes do not unpack to {} columns of {} rows", bytes.size(), columns, rows);
  std::vector<std::vector<T>> values(columns, std::vector<T>(rows));
  const std::uint8_t* column_start = shuffled.data();
  for (auto& column : values) {
    for (std::size_t row = 0; row < rows; ++row) {
      std::uint8_t value[sizeof(T)];
      for (std::size_t byte = 0; byte < sizeof(T); ++byte) value[byte] = column_start[byte * rows + row];
      std::memcpy(&column[row], value, sizeof(T));
    }
    column_start += rows * sizeof(T);
  }
  return values;
}

}  // namespace

std::vector<std::uint8_t> PackColumns(const std::vector<std::span<const double>>& columns) {
  return Pack(columns);
}

std::vector<std::uint8_t> PackColumns(const std::vector<std::span<const Quality>>& columns) {
  return Pack(columns);
}

Result<std::vector<std::vector<double>>> UnpackColumns(std::span<const std::uint8_t> bytes,
                                                       std::size_t columns, std::size_t rows) {
  return Unpack<double>(bytes, columns, rows);
}

Result<std::vector<std::vector<Quality>>> UnpackFlags(std::span<const std::uint8_t> bytes,
                                                      std::size_t columns, std::size_t rows) {
  return Unpack<Quality>(bytes, columns, rows);
}

}  // namespace hydroscope
