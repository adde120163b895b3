// libFuzzer target: whatever a blob of the database holds - raw rows, their flags, a Gram -
// it becomes columns of the size asked for, a Gram, or an error with words. Checksums are made to fit, so that what
// lies behind them is reached. What is packed comes back to the bit. The first byte chooses the kind.
#include <zlib.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "storage/blobs/gram_codec.h"
#include "storage/blobs/raw_codec.h"

namespace {

using namespace hydroscope;

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kColumns = 3, kMostRows = 130;  // more than the 100 rows that are not deflated

void Require(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

template <typename Columns>
void CheckColumns(const Result<Columns>& columns, std::size_t rows) {
  if (!columns) return Require(!columns.error().text.empty(), "an error without words");
  Require(columns->size() == kColumns, "another number of columns");
  for (const auto& column : *columns) Require(column.size() == rows, "another number of rows");
}

/// As PackColumns would deflate `plain`; version 1 without a byte in front.
Bytes Deflated(std::span<const std::uint8_t> plain, bool version_1) {
  Bytes bytes(compressBound(plain.size()) + 1);
  uLongf size = bytes.size() - 1;
  bytes[0] = 2;
  Require(compress2(bytes.data() + 1, &size, plain.data(), plain.size(), 1) == Z_OK, "zlib failed");
  bytes.resize(size + 1);
  if (version_1) bytes.erase(bytes.begin());
  return bytes;
}

void UnpackAsColumns(std::span<const std::uint8_t> bytes, std::size_t rows) {
  CheckColumns(UnpackColumns(bytes, kColumns, rows), rows);
  CheckColumns(UnpackFlags(bytes, kColumns, rows), rows);
}

/// The bytes as values of columns.
template <typename T, typename Unpack>
void PackAndUnpack(std::span<const std::uint8_t> bytes, Unpack unpack) {
  const std::size_t rows = std::min(bytes.size() / sizeof(T) / kColumns, kMostRows);
  std::vector<std::vector<T>> values(kColumns, std::vector<T>(rows));
  for (std::size_t c = 0; c < kColumns && rows > 0; ++c)
    std::memcpy(values[c].data(), bytes.data() + c * rows * sizeof(T), rows * sizeof(T));
  const auto back = unpack(PackColumns({std::span<const T>(values[0]), std::span<const T>(values[1]),
                                        std::span<const T>(values[2])}),
                           kColumns, rows);
  CheckColumns(back, rows);
  Require(back.has_value(), "what was packed does not unpack");
  for (std::size_t c = 0; c < kColumns && rows > 0; ++c)
    Require(std::memcmp(values[c].data(), (*back)[c].data(), rows * sizeof(T)) == 0, "other bits came back");
}

void DecodeAsGram(Bytes bytes) {
  if (bytes.size() >= sizeof(std::uint32_t)) {
    const std::size_t size = bytes.size() - sizeof(std::uint32_t);
    const auto checksum = static_cast<std::uint32_t>(crc32(crc32(0, nullptr, 0), bytes.data(), size));
    std::memcpy(bytes.data() + size, &checksum, sizeof(checksum));
  }
  const auto gram = DecodeGram(bytes);
  if (!gram) return Require(!gram.error().text.empty(), "an error without words");
  const auto again = DecodeGram(EncodeGram(*gram, NoisePrecision::kDouble));
  Require(again && again->blocks == gram->blocks &&
              again->integral.dimension() == gram->integral.dimension() &&
              again->flow.dimension() == gram->flow.dimension(),
          "a Gram reads back differently");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const int kind = data[0] % 7;
  const std::size_t rows = data[1] % kMostRows;
  const std::span bytes(data + 2, size - 2);
  switch (kind) {
    case 0:
      UnpackAsColumns(bytes, rows);
      break;
    case 1:
    case 2:
      UnpackAsColumns(Deflated(bytes, kind == 2), rows);
      break;
    case 3:
      PackAndUnpack<double>(bytes, UnpackColumns);
      break;
    case 4:
      PackAndUnpack<Quality>(bytes, UnpackFlags);
      break;
    default:
      DecodeAsGram({bytes.begin(), bytes.end()});
  }
  return 0;
}
