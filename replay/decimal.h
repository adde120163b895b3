#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

namespace hydroscope {

/// Bytes that must be readable (any content) after the end of every text handed to ParseDecimal.
inline constexpr int kDecimalPadding = 16;

/// Reads the decimal number that starts exactly at `text`: [+-]digits[point digits][e[+-]digits], `point`
/// being '.' or ','. Correctly rounded (same result as strtod). Returns the first character after the number;
/// nullptr if no number starts there. The text must end with a character that cannot belong to a number (a
/// separator or a line end) and be followed by kDecimalPadding readable bytes.
const char* ParseDecimalGeneral(const char* text, char point, double& value);

/// As ParseDecimalGeneral; nullptr also if the number is too large for a double.
const char* ParseDecimalFinite(const char* text, char point, double& value);

namespace decimal_detail {

static_assert(std::endian::native == std::endian::little, "eight digits at a time need little-endian loads");

inline constexpr std::array<double, 23> kPowersOfTen = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                        1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                        1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/// For the digits of a fraction, at most eight.
inline constexpr std::array<std::uint64_t, 9> kWholePowersOfTen = {1,      10,      100,      1000,     10000,
                                                                   100000, 1000000, 10000000, 100000000};

inline constexpr int kExactDigits = 15;  ///< any integer of so many digits is a double

inline bool IsDigit(char c) { return static_cast<unsigned char>(c - '0') < 10; }

/// Eight characters as digit values 0...9, one per byte, first character in the lowest byte.
inline std::uint64_t LoadDigits(const char* text) {
  std::uint64_t bytes;
  std::memcpy(&bytes, text, sizeof bytes);
  return bytes ^ 0x3030303030303030u;
}

/// The lowest set bit lies in the first byte that is no digit; 0 if all eight are digits. (A carry can only
/// disturb bytes after the first that is no digit.)
inline std::uint64_t NonDigits(std::uint64_t digits) {
  return ((digits + 0x7676767676767676u) | digits) & 0x8080808080808080u;
}

/// Value of eight digits, first digit (lowest byte) most significant.
inline std::uint64_t EightDigits(std::uint64_t digits) {
  digits = digits * 10 + (digits >> 8);
  return (((digits & 0x000000FF000000FFu) * 0x000F424000000064u) +
          (((digits >> 16) & 0x000000FF000000FFu) * 0x0000271000000001u)) >>
         32;
}

}  // namespace decimal_detail

/// As ParseDecimalGeneral, quick for numbers of up to eight digits on either side of the point (together at
/// most 15): an integer mantissa below 2^53 divided by an exact power of ten is correctly rounded (Clinger
/// 1990). May stop at an 'e', where the caller finds no separator and calls ParseDecimalFinite. nullptr if no
/// number starts there, or one too large for a double.
inline const char* ParseDecimal(const char* text, char point, double& value) {
  using namespace decimal_detail;
  const char* p = text;
  const bool negative = *p == '-';
  p += negative;
  const std::uint64_t whole = LoadDigits(p);
  const int whole_bits = std::countr_zero(NonDigits(whole)) & ~7;  // 8 x number of digits before the point
  p += whole_bits >> 3;
  double magnitude;
  if (*p == point) {
    ++p;
    const std::uint64_t fraction = LoadDigits(p);
    const int fraction_bits = std::countr_zero(NonDigits(fraction)) & ~7;
    p += fraction_bits >> 3;
    const int bits = whole_bits + fraction_bits;
    std::uint64_t mantissa;
    if (bits <= 64) {
      if (bits == 0) return nullptr;
      if (whole_bits == 64 || fraction_bits == 64) return ParseDecimalFinite(text, point, value);
      const std::uint64_t digits =
          (whole & ((std::uint64_t{1} << whole_bits) - 1)) | (fraction << whole_bits);
      mantissa = EightDigits(digits << (64 - bits));
    } else {
      if (bits > 8 * kExactDigits || IsDigit(*p)) return ParseDecimalFinite(text, point, value);
      mantissa = EightDigits(whole << (64 - whole_bits)) * kWholePowersOfTen[fraction_bits >> 3] +
                 EightDigits(fraction << (64 - fraction_bits));
    }
    magnitude = static_cast<double>(static_cast<std::int64_t>(mantissa)) / kPowersOfTen[fraction_bits >> 3];
  } else {
    if (whole_bits == 0 || IsDigit(*p)) return ParseDecimalFinite(text, point, value);
    magnitude = static_cast<double>(static_cast<std::int64_t>(EightDigits(whole << (64 - whole_bits))));
  }
  value = std::bit_cast<double>(std::bit_cast<std::uint64_t>(magnitude) | (std::uint64_t{negative} << 63));
  return p;
}

}  // namespace hydroscope
