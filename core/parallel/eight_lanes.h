#pragma once

namespace hydroscope {

/// Numbers in two vectors of four: vectors of eight, without AVX-512, are taken apart into words in memory by GCC 12 and put
/// together again, at every operation. Aligned as memory without AVX is, whichever processor a function is compiled for.
struct EightLanes {
  static constexpr int kCount = 8;
  typedef double Four __attribute__((vector_size(32), aligned(16)));
  Four half[2] = {};
  double operator[](int lane) const { return half[lane / 4][lane % 4]; }
  void Set(int lane, double value) { half[lane / 4][lane % 4] = value; }
};

[[gnu::always_inline]] inline EightLanes InAllLanes(double value) {
  EightLanes lanes;
  for (auto& half : lanes.half) half = EightLanes::Four{value, value, value, value};
  return lanes;
}
[[gnu::always_inline]] inline void AddProduct(const EightLanes& a, const EightLanes& b, EightLanes& sum) {
  for (int h = 0; h < 2; ++h) sum.half[h] += a.half[h] * b.half[h];
}
[[gnu::always_inline]] inline void SubtractProduct(const EightLanes& a, const EightLanes& b,
                                                   EightLanes& left) {
  for (int h = 0; h < 2; ++h) left.half[h] -= a.half[h] * b.half[h];
}
[[gnu::always_inline]] inline void PutProduct(const EightLanes& a, const EightLanes& b, EightLanes& out) {
  for (int h = 0; h < 2; ++h) out.half[h] = a.half[h] * b.half[h];
}
[[gnu::always_inline]] inline void PutDifference(const EightLanes& a, const EightLanes& b, EightLanes& out) {
  for (int h = 0; h < 2; ++h) out.half[h] = a.half[h] - b.half[h];
}

}  // namespace hydroscope
