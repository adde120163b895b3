#include "storage/blobs/raw_codec.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "core/bytes.h"

namespace hydroscope {
namespace {

constexpr std::uint8_t kVersion = 2;  // version 1 had no such byte: it begins with zlib's 0x78
constexpr std::uint8_t kZlibBegins = 0x78;
// Of zlib; noise repeats nothing but runs, so that Z_RLE loses 2 % and takes half the time.
constexpr int kLevel = 6;
constexpr int kMemoryLevel = 7;                 // of zlib: a block holds 8191 bytes, those of one column
constexpr std::size_t kOwnCode = 1024;          // bytes of columns that are worth a code of their own
constexpr std::size_t kFewRows = 100;           // not worth any: an estimate may wait for them
constexpr std::size_t kMostRows = 1u << 20;     // of a chunk; a damaged file may claim any number
constexpr int kHighestOrder = 2;                // of the differences
constexpr std::int64_t kLargestCorrection = 3;  // units in the last place
constexpr double kMostSteps = 1e9;

using Integers = std::vector<std::int64_t>;

// ---- numbers <-> integers

/// Bit pattern as a number that grows with the value, so that neighbours differ by little.
std::int64_t Ordered(double value) {
  const auto bits = std::bit_cast<std::int64_t>(value);
  return bits < 0 ? bits ^ std::numeric_limits<std::int64_t>::max() : bits;
}
double FromOrdered(std::int64_t number) {
  return std::bit_cast<double>(number < 0 ? number ^ std::numeric_limits<std::int64_t>::max() : number);
}

/// Differences wrap around, so that every pattern comes back.
std::int64_t Minus(std::int64_t a, std::int64_t b) {
  return std::int64_t(std::uint64_t(a) - std::uint64_t(b));
}
std::int64_t Plus(std::int64_t a, std::int64_t b) {
  return std::int64_t(std::uint64_t(a) + std::uint64_t(b));
}

/// A column of a converter: value = step * whole number, to a few units in the last place.
struct Steps {
  double step = 0;
  Integers numbers, corrections;  ///< `corrections` empty: the products are exact
};

/// The numbers of steps of all values; nullopt if the column is no multiple of `step`.
std::optional<Steps> CountSteps(std::span<const double> values, double step) {
  // Adding it leaves no digits behind the point; inlined, unlike nearbyint.
  constexpr double kToWhole = 0x1.8p52;
  Steps found{.step = step, .numbers = {}, .corrections = {}};
  found.numbers.reserve(values.size());
  bool exact = true;
  for (const double value : values) {
    const double ratio = value / step;
    if (!(std::abs(ratio) < kMostSteps)) return std::nullopt;
    const double steps = (ratio + kToWhole) - kToWhole;
    const auto number = static_cast<std::int64_t>(steps);  // -0.0 becomes 0, as for who reads it back
    const std::int64_t correction = Minus(Ordered(value), Ordered(static_cast<double>(number) * step));
    if (correction < -kLargestCorrection || correction > kLargestCorrection) return std::nullopt;
    found.numbers.push_back(number);
    found.corrections.push_back(correction);
    exact = exact && correction == 0;
  }
  if (exact) found.corrections.clear();
  return found;
}

/// The step of an analogue-to-digital converter behind the column, if there is one: the smallest difference
/// of neighbours, made exact by the largest value.
std::optional<Steps> FindSteps(std::span<const double> values) {
  double least = std::numeric_limits<double>::infinity(), largest = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) return std::nullopt;
    largest = std::max(largest, std::abs(values[i]));
    if (i > 0 && values[i] != values[i - 1]) least = std::min(least, std::abs(values[i] - values[i - 1]));
  }
  if (!std::isfinite(least) || largest / least > kMostSteps) return std::nullopt;
  std::optional<Steps> best;
  for (const int part : {1, 2, 3}) {  // the smallest difference seen may be several steps
    const double number = std::nearbyint(largest / least * part);
    double step = largest / number;
    for (int off = 0; off < 3; ++off) {
      if (auto counted = CountSteps(values, step); counted && (!best || counted->corrections.empty()))
        best = std::move(counted);
      if (best && best->corrections.empty()) return best;
      step = std::nextafter(largest / number, off == 0 ? 0 : std::numeric_limits<double>::infinity());
    }
    if (best) return best;
  }
  return best;
}

// ---- integers <-> bytes

std::uint64_t Folded(std::int64_t number) {  // small magnitudes of both signs become small numbers
  return std::uint64_t(number) << 1 ^ std::uint64_t(number >> 63);
}
std::int64_t Unfolded(std::uint64_t folded) { return std::int64_t(folded >> 1) ^ -std::int64_t(folded & 1); }

/// How often to difference so that the least bits are left.
int BestOrder(const Integers& numbers) {
  std::array<std::int64_t, kHighestOrder + 1> bits{};
  std::int64_t before = 0, difference_before = 0;
  for (const std::int64_t number : numbers) {
    const std::int64_t difference = Minus(number, before);
    bits[0] += std::bit_width(Folded(number));
    bits[1] += std::bit_width(Folded(difference));
    bits[2] += std::bit_width(Folded(Minus(difference, difference_before)));
    before = number;
    difference_before = difference;
  }
  return static_cast<int>(std::ranges::min_element(bits) - bits.begin());
}

/// Order, width in bytes, then the first bytes of all differences, their second bytes, ...
void PutIntegers(Integers numbers, std::vector<std::uint8_t>& out) {
  const int order = BestOrder(numbers);
  for (int k = 0; k < order; ++k)
    for (std::size_t i = numbers.size(); i-- > static_cast<std::size_t>(k) + 1;)
      numbers[i] = Minus(numbers[i], numbers[i - 1]);
  std::uint64_t all = 0;
  for (const std::int64_t number : numbers) all |= Folded(number);
  const int width = (std::bit_width(all) + 7) / 8;
  out.push_back(static_cast<std::uint8_t>(order));
  out.push_back(static_cast<std::uint8_t>(width));
  const std::size_t begin = out.size(), rows = numbers.size();
  out.resize(begin + static_cast<std::size_t>(width) * rows);
  for (int byte = 0; byte < width; ++byte)
    for (std::size_t i = 0; i < rows; ++i)
      out[begin + static_cast<std::size_t>(byte) * rows + i] =
          static_cast<std::uint8_t>(Folded(numbers[i]) >> (8 * byte));
}

std::optional<Integers> GetIntegers(ByteReader& in, std::size_t rows) {
  const auto order = in.Get<std::uint8_t>(), width = in.Get<std::uint8_t>();
  if (!in.ok() || order > kHighestOrder || width > 8) return std::nullopt;
  std::vector<std::uint64_t> folded(rows);
  for (int byte = 0; byte < width; ++byte)
    for (auto& number : folded) number |= std::uint64_t(in.Get<std::uint8_t>()) << (8 * byte);
  if (!in.ok()) return std::nullopt;
  Integers numbers(rows);
  std::transform(folded.begin(), folded.end(), numbers.begin(), Unfolded);
  for (int k = order; k-- > 0;)
    for (std::size_t i = static_cast<std::size_t>(k) + 1; i < rows; ++i)
      numbers[i] = Plus(numbers[i], numbers[i - 1]);
  return numbers;
}

// ---- columns

enum Kind : std::uint8_t { kPatterns = 0, kSteps = 1, kCorrectedSteps = 2 };

void PutColumn(std::span<const double> values, std::vector<std::uint8_t>& out) {
  if (auto steps = FindSteps(values)) {
    const auto step = std::bit_cast<std::array<std::uint8_t, sizeof(double)>>(steps->step);
    out.push_back(steps->corrections.empty() ? kSteps : kCorrectedSteps);
    out.insert(out.end(), step.begin(), step.end());
    PutIntegers(std::move(steps->numbers), out);
    if (!steps->corrections.empty()) PutIntegers(std::move(steps->corrections), out);
    return;
  }
  out.push_back(kPatterns);
  Integers patterns(values.size());
  std::transform(values.begin(), values.end(), patterns.begin(), Ordered);
  PutIntegers(std::move(patterns), out);
}

void PutColumn(std::span<const Quality> flags, std::vector<std::uint8_t>& out) {
  PutIntegers(Integers(flags.begin(), flags.end()), out);
}

std::optional<std::vector<double>> GetDoubles(ByteReader& in, std::size_t rows) {
  const auto kind = in.Get<std::uint8_t>();
  if (!in.ok() || kind > kCorrectedSteps) return std::nullopt;
  const double step = kind == kPatterns ? 0 : in.Get<double>();
  const auto numbers = GetIntegers(in, rows);
  if (!numbers) return std::nullopt;
  std::vector<double> values(rows);
  std::transform(numbers->begin(), numbers->end(), values.begin(), [&](std::int64_t number) {
    return kind == kPatterns ? FromOrdered(number) : static_cast<double>(number) * step;
  });
  if (kind != kCorrectedSteps) return values;
  const auto corrections = GetIntegers(in, rows);
  if (!corrections) return std::nullopt;
  for (std::size_t i = 0; i < rows; ++i) values[i] = FromOrdered(Plus(Ordered(values[i]), (*corrections)[i]));
  return values;
}

std::optional<std::vector<Quality>> GetFlags(ByteReader& in, std::size_t rows) {
  const auto numbers = GetIntegers(in, rows);
  if (!numbers) return std::nullopt;
  return std::vector<Quality>(numbers->begin(), numbers->end());
}

std::optional<std::vector<std::uint8_t>> Inflate(std::span<const std::uint8_t> bytes, std::size_t most) {
  std::vector<std::uint8_t> plain(most);
  uLongf size = most;
  if (uncompress(plain.data(), &size, bytes.data(), bytes.size()) != Z_OK) return std::nullopt;
  plain.resize(size);
  return plain;
}

/// A zlib stream (RFC 1950) of stored blocks: the bytes as they are.
void PutStored(std::span<const std::uint8_t> bytes, std::vector<std::uint8_t>& out) {
  const auto put = [&](std::initializer_list<std::uint32_t> values) {
    for (const std::uint32_t value : values) out.push_back(static_cast<std::uint8_t>(value));
  };
  put({kZlibBegins, 0x01});
  const auto sum = static_cast<std::uint32_t>(adler32_z(adler32(0, nullptr, 0), bytes.data(), bytes.size()));
  do {
    const auto size = static_cast<std::uint32_t>(std::min<std::size_t>(bytes.size(), 0xffff));
    put({size == bytes.size(), size, size >> 8, ~size, ~size >> 8});
    out.insert(out.end(), bytes.begin(), bytes.begin() + size);
    bytes = bytes.subspan(size);
  } while (!bytes.empty());
  put({sum >> 24, sum >> 16, sum >> 8, sum});
}

/// Version 1: the first bytes of all values of a column, then their second bytes, ...; all columns together.
template <typename T>
std::vector<std::vector<T>> Unshuffle(const std::vector<std::uint8_t>& shuffled, std::size_t columns,
                                      std::size_t rows) {
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

template <typename T, typename Get>
Result<std::vector<std::vector<T>>> Unpack(std::span<const std::uint8_t> bytes, std::size_t columns,
                                           std::size_t rows, Get get) {
  const auto damaged = [&] {
    return BadInput("damaged: {} bytes do not unpack to {} columns of {} rows", bytes.size(), columns, rows);
  };
  if (bytes.empty() || rows > kMostRows) return damaged();
  if (bytes.front() == kZlibBegins) {
    const auto shuffled = Inflate(bytes, columns * rows * sizeof(T));
    if (!shuffled || shuffled->size() != columns * rows * sizeof(T)) return damaged();
    return Unshuffle<T>(*shuffled, columns, rows);
  }
  constexpr std::size_t kHeadOfColumn = 32;
  if (bytes.front() != kVersion) return damaged();
  const auto plain = Inflate(bytes.subspan(1), columns * (kHeadOfColumn + 16 * rows));
  if (!plain) return damaged();
  ByteReader in(*plain);
  std::vector<std::vector<T>> values;
  for (std::size_t c = 0; c < columns; ++c) {
    auto column = get(in, rows);
    if (!column) return damaged();
    values.push_back(std::move(*column));
  }
  if (!in.at_end()) return damaged();
  return values;
}

}  // namespace

// ---- zlib, one block with a code of its own for each column, or for several short ones

/// One object deflates one stream after the other.
class ColumnPacker::Deflater {
 public:
  Deflater() { deflateInit2(&stream_, kLevel, Z_DEFLATED, MAX_WBITS, kMemoryLevel, Z_RLE); }
  ~Deflater() { deflateEnd(&stream_); }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;

  void Add(const std::vector<std::uint8_t>& bytes, bool last, std::vector<std::uint8_t>& out) {
    stream_.next_in = const_cast<Bytef*>(bytes.data());
    stream_.avail_in = static_cast<uInt>(bytes.size());
    const std::size_t begin = out.size();
    out.resize(begin + deflateBound(&stream_, bytes.size()) + 64);
    stream_.next_out = out.data() + begin;
    stream_.avail_out = static_cast<uInt>(out.size() - begin);
    deflate(&stream_, last ? Z_FINISH : Z_BLOCK);  // cannot fail into deflateBound bytes
    out.resize(out.size() - stream_.avail_out);
  }

  template <typename T>
  std::vector<std::uint8_t> Pack(const std::vector<std::span<const T>>& columns) {
    std::vector<std::uint8_t> packed = {kVersion};
    std::vector<std::uint8_t> plain;
    if (columns.front().size() <= kFewRows) {
      for (const auto& column : columns) PutColumn(column, plain);
      PutStored(plain, packed);
      return packed;
    }
    deflateReset(&stream_);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const bool last = c + 1 == columns.size();
      PutColumn(columns[c], plain);
      if (plain.size() < kOwnCode && !last) continue;
      Add(plain, last, packed);
      plain.clear();
    }
    return packed;
  }

 private:
  z_stream stream_{};
};

ColumnPacker::ColumnPacker() : deflater_(std::make_unique<Deflater>()) {}
ColumnPacker::~ColumnPacker() = default;

std::vector<std::uint8_t> ColumnPacker::Pack(const std::vector<std::span<const double>>& columns) {
  return deflater_->Pack(columns);
}

std::vector<std::uint8_t> ColumnPacker::Pack(const std::vector<std::span<const Quality>>& columns) {
  return deflater_->Pack(columns);
}

std::vector<std::uint8_t> PackColumns(const std::vector<std::span<const double>>& columns) {
  return ColumnPacker().Pack(columns);
}

std::vector<std::uint8_t> PackColumns(const std::vector<std::span<const Quality>>& columns) {
  return ColumnPacker().Pack(columns);
}

Result<std::vector<std::vector<double>>> UnpackColumns(std::span<const std::uint8_t> bytes,
                                                       std::size_t columns, std::size_t rows) {
  return Unpack<double>(bytes, columns, rows, GetDoubles);
}

Result<std::vector<std::vector<Quality>>> UnpackFlags(std::span<const std::uint8_t> bytes,
                                                      std::size_t columns, std::size_t rows) {
  return Unpack<Quality>(bytes, columns, rows, GetFlags);
}

}  // namespace hydroscope
