#pragma once

#include <cstdint>
#include <random>
#include <string_view>

namespace hydroscope {

/// Seeded random numbers that are the same with every standard library: std::mt19937_64 (whose output the standard
/// fixes) with own uniform and normal transforms (std::normal_distribution differs between libraries).
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed) : engine_(seed) {}

  /// Uniform in [0, 1), 53 random bits.
  double Uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }
  /// Standard normal by the polar method (Marsaglia & Bray 1964).
  double Normal();

 private:
  std::mt19937_64 engine_;
  double spare_ = 0;
  bool has_spare_ = false;
};

/// Seed of an independent stream: the same seed with another purpose gives unrelated numbers (splitmix64 over
/// the seed and the FNV-1a hash of the purpose).
std::uint64_t StreamSeed(std::uint64_t seed, std::string_view purpose);

}  // namespace hydroscope
