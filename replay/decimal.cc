#include "replay/decimal.h"

#include <fast_float/fast_float.h>

#include <cmath>

namespace hydroscope {
namespace {

/// A number taken apart: (-1)^negative * mantissa * 10^exponent.
struct Parts {
  std::uint64_t mantissa = 0;
  std::int64_t exponent = 0;
  int significant = 0;  ///< digits in the mantissa, leading zeros not counted
  bool any_digit = false;
};

const char* ReadDigits(const char* p, bool after_point, Parts& parts) {
  for (; decimal_detail::IsDigit(*p); ++p) {
    parts.any_digit = true;
    if (parts.significant > 0 || *p != '0') ++parts.significant;
    if (parts.significant <= 19) parts.mantissa = parts.mantissa * 10 + static_cast<std::uint64_t>(*p - '0');
    if (after_point) --parts.exponent;
  }
  return p;
}

/// Reads "e-12" if it is there; "e" without digits does not belong to the number.
const char* ReadExponent(const char* p, Parts& parts) {
  if (*p != 'e' && *p != 'E') return p;
  const char* digits = p + 1;
  const bool negative = *digits == '-';
  if (*digits == '-' || *digits == '+') ++digits;
  if (!decimal_detail::IsDigit(*digits)) return p;
  std::int64_t exponent = 0;
  for (; decimal_detail::IsDigit(*digits); ++digits)
    if (exponent < 100000) exponent = exponent * 10 + (*digits - '0');
  parts.exponent += negative ? -exponent : exponent;
  return digits;
}

}  // namespace

const char* ParseDecimalGeneral(const char* text, char point, double& value) {
  using decimal_detail::kPowersOfTen;
  const char* p = text;
  const bool negative = *p == '-';
  if (*p == '-' || *p == '+') ++p;
  const char* const unsigned_text = p;
  Parts parts;
  p = ReadDigits(p, false, parts);
  if (*p == point) p = ReadDigits(p + 1, true, parts);
  if (!parts.any_digit) return nullptr;
  p = ReadExponent(p, parts);

  double magnitude = 0;
  if (parts.significant <= 19 && parts.mantissa <= (std::uint64_t{1} << 53) && parts.exponent >= -22 &&
      parts.exponent <= 22) {
    const double mantissa = static_cast<double>(parts.mantissa);
    magnitude = parts.exponent < 0 ? mantissa / kPowersOfTen[-parts.exponent]
                                   : mantissa * kPowersOfTen[parts.exponent];
  } else {
    const fast_float::parse_options options(fast_float::chars_format::general, point);
    if (fast_float::from_chars_advanced(unsigned_text, p, magnitude, options).ptr != p) return nullptr;
  }
  value = negative ? -magnitude : magnitude;
  return p;
}

const char* ParseDecimalFinite(const char* text, char point, double& value) {
  const char* end = ParseDecimalGeneral(text, point, value);
  return end != nullptr && std::isfinite(value) ? end : nullptr;
}

}  // namespace hydroscope
