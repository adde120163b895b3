#include "replay/field_shape.h"

#include <algorithm>

#include "replay/decimal.h"

namespace hydroscope {

bool FieldShape::Learn(const char* text, std::int64_t characters, char point) {
  using decimal_detail::IsDigit, decimal_detail::kExactDigits, decimal_detail::kPowersOfTen;
  if (characters > kWidth) return false;
  const int last = static_cast<int>(characters) - 1;
  const bool negative = *text == '-';
  char digit_at[kWidth];
  int digits = 0, fraction = 0;
  bool past_point = false;
  for (int k = negative ? 1 : 0; k < last; ++k) {
    if (text[k] == point && !past_point) {
      past_point = true;
    } else if (IsDigit(text[k])) {
      digit_at[digits++] = static_cast<char>(k);
      fraction += past_point;
    } else {
      return false;
    }
  }
  if (digits == 0 || digits > kExactDigits || IsDigit(text[last])) return false;
  FieldShape shape;
  std::fill(shape.marks, shape.marks + kWidth, '\0');
  std::fill(shape.places, shape.places + kWidth, static_cast<char>(-1));
  std::copy_n(digit_at, digits, shape.places + kWidth - digits);
  shape.marked = 0;
  for (int k = 0; k <= last; ++k) {
    if (IsDigit(text[k])) continue;
    shape.marks[k] = text[k];
    shape.marked |= 1u << k;
  }
  shape.within = (2u << last) - 1;
  shape.width = characters;
  shape.sign = std::uint64_t{negative} << 63;
  shape.divisor = kPowersOfTen[fraction];
  *this = shape;
  return true;
}

bool CanReadShapes() {
#ifdef HYDROSCOPE_HAS_FIELD_SHAPES
  return __builtin_cpu_supports("avx2");
#else
  return false;
#endif
}

}  // namespace hydroscope
