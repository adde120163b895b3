#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

namespace hydroscope {

/// 64-bit FNV-1a hash (Fowler, Noll, Vo 1991) taken over eight bytes at a time, then byte by byte at the end
/// of each value; every value enters with its length, so that neighbours cannot be confused.
class Fnv1a {
 public:
  void Add(std::int64_t value) { Mix(std::bit_cast<std::uint64_t>(value)); }
  /// All NaN are the same value, and so are 0 and -0: the file keeps no difference either.
  void Add(double value) {
    if (std::isnan(value)) value = std::numeric_limits<double>::quiet_NaN();
    if (value == 0) value = 0;
    Mix(std::bit_cast<std::uint64_t>(value));
  }
  void Add(std::span<const std::uint8_t> bytes) {
    Mix(bytes.size());
    while (bytes.size() >= 8) {
      std::uint64_t word = 0;
      for (int i = 0; i < 8; ++i) word |= static_cast<std::uint64_t>(bytes[i]) << (8 * i);
      Mix(word);
      bytes = bytes.subspan(8);
    }
    for (const std::uint8_t byte : bytes) Mix(byte);
  }
  void Add(std::string_view text) {
    Add(std::span<const std::uint8_t>(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
  }
  std::uint64_t value() const { return hash_; }

 private:
  void Mix(std::uint64_t word) {
    hash_ = (hash_ ^ word) * 0x100000001b3ull;
    hash_ ^= hash_ >> 29;  // carries the high bits of a word back down, which the product alone does not
  }
  std::uint64_t hash_ = 0xcbf29ce484222325ull;
};

}  // namespace hydroscope
