#pragma once

#include <cstdint>
#include <cstring>

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#define HYDROSCOPE_HAS_FIELD_SHAPES
#endif

namespace hydroscope {

/// How the number of a field is written: where its sign, point, digits and the character behind it stand.
/// Logs write the numbers of a column alike, row after row; a field of known shape is then checked and read
/// at once (Lemire 2021 on the vector instructions for digits), instead of being searched for its point and
/// its end.
struct FieldShape {
  /// Characters of the longest field that has a shape, with the one behind it.
  static constexpr int kWidth = 16;

  alignas(16) char marks[kWidth] = {'0'};  ///< sign, point and the character behind; 0 at digits
  alignas(16) char places[kWidth] = {};    ///< which character is each of 16 digits; -1: none, a zero
  std::uint32_t marked = 1;                ///< bits of the characters in `marks`
  std::uint32_t within = 1;                ///< bits of all characters
  std::int64_t width = 0;                  ///< characters; 0: not known yet, and nothing fits `marks`
  std::uint64_t sign = 0;                  ///< sign bit of the number
  double divisor = 1;                      ///< power of ten

  /// The shape of the field at `text` with the character behind it; false, and nothing changed, if it is no
  /// bare decimal number of at most 15 digits, or too long.
  bool Learn(const char* text, std::int64_t characters, char point);
};

/// Whether the processor can read by shapes: AVX2, whose encoding leaves the upper halves of registers alone;
/// SSE's here took twice the time.
bool CanReadShapes();

#ifdef HYDROSCOPE_HAS_FIELD_SHAPES
/// Reads the number if the field at `text` has this shape; 16 bytes must be readable there.
[[gnu::target("avx2"), gnu::always_inline]] inline bool ReadShape(const char* text, const FieldShape& shape,
                                                                  double& value) {
  const __m128i raw = _mm_loadu_si128(reinterpret_cast<const __m128i*>(text));
  const __m128i marks = _mm_load_si128(reinterpret_cast<const __m128i*>(shape.marks));
  const __m128i digits = _mm_sub_epi8(raw, _mm_set1_epi8('0'));
  const __m128i no_digit = _mm_cmpeq_epi8(_mm_max_epu8(digits, _mm_set1_epi8(10)), digits);
  const auto other = static_cast<std::uint32_t>(_mm_movemask_epi8(no_digit));
  const auto fits = static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_cmpeq_epi8(raw, marks)));
  if ((((other ^ shape.marked) | (fits ^ shape.marked)) & shape.within) != 0) return false;
  const __m128i places = _mm_load_si128(reinterpret_cast<const __m128i*>(shape.places));
  const __m128i tens = _mm_set1_epi16(1 << 8 | 10), hundreds = _mm_set1_epi32(1 << 16 | 100),
                myriads = _mm_set1_epi32(1 << 16 | 10000);
  const __m128i pairs = _mm_maddubs_epi16(_mm_shuffle_epi8(digits, places), tens);
  const __m128i fours = _mm_madd_epi16(pairs, hundreds);
  const __m128i eights = _mm_madd_epi16(_mm_packus_epi32(fours, fours), myriads);
  const auto both = static_cast<std::uint64_t>(_mm_cvtsi128_si64(eights));
  const std::uint64_t integer = (both & 0xffffffff) * 100000000 + (both >> 32);
  const double magnitude = static_cast<double>(static_cast<std::int64_t>(integer)) / shape.divisor;
  std::uint64_t bits;
  std::memcpy(&bits, &magnitude, sizeof bits);
  bits |= shape.sign;
  std::memcpy(&value, &bits, sizeof bits);
  return true;
}
#endif

}  // namespace hydroscope
