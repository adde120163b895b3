#include "simulator/own_states/excitation.h"

#include <cmath>
#include <numbers>
#include <random>

namespace hydroscope {
namespace {

std::vector<double> Multisine(int rows, double highest, std::mt19937_64& random) {
  constexpr int kSines = 120;
  std::uniform_real_distribution<double> frequency(0.001, highest), phase(0, 2 * std::numbers::pi);
  std::vector<double> out(static_cast<std::size_t>(rows), 0.0);
  for (int k = 0; k < kSines; ++k) {
    const double w = 2 * std::numbers::pi * frequency(random), begin = phase(random);
    for (std::size_t row = 0; row < out.size(); ++row)
      out[row] += std::sqrt(2.0 / kSines) * std::sin(w * static_cast<double>(row) + begin);
  }
  return out;
}

/// Two lags in a row, brought back to unit rms.
std::vector<double> FilteredNoise(int rows, double highest, std::mt19937_64& random) {
  const double a = std::exp(-2 * std::numbers::pi * highest);
  // Energy of the impulse response n -> (n + 1) a^n: (1 + a^2) / (1 - a^2)^3.
  const double gain = std::sqrt(std::pow(1 - a * a, 3) / (1 + a * a));
  std::normal_distribution<double> normal;
  std::vector<double> out;
  double first = 0, second = 0;
  for (int row = 0; row < rows; ++row) {
    first = a * first + normal(random);
    second = a * second + first;
    out.push_back(gain * second);
  }
  return out;
}

std::vector<double> Steps(int rows, double highest, std::mt19937_64& random) {
  std::uniform_real_distribution<double> level(-1.7, 1.7), share(0.5, 1.5);
  std::vector<double> out;
  int left = 0;
  for (int row = 0; row < rows; ++row) {
    if (left-- <= 0) {
      out.push_back(level(random));
      left = static_cast<int>(share(random) / highest);
    } else {
      out.push_back(out.back());
    }
  }
  return out;
}

}  // namespace

std::vector<double> ExcitationOf(Excitation kind, int rows, double highest, std::uint64_t seed) {
  constexpr int kGrowth = 1500;  // rows
  std::mt19937_64 random(seed);
  switch (kind) {
    case Excitation::kMultisine:
      return Multisine(rows, highest, random);
    case Excitation::kSteps:
      return Steps(rows, highest, random);
    case Excitation::kFilteredNoise:
    case Excitation::kGrowing:
      break;
  }
  std::vector<double> out = FilteredNoise(rows, highest, random);
  for (std::size_t row = 0; kind == Excitation::kGrowing && row < out.size(); ++row)
    out[row] *= 0.1 + 1.5 * static_cast<double>(row % kGrowth) / kGrowth;
  return out;
}

}  // namespace hydroscope
