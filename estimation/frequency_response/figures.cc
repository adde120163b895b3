#include "estimation/frequency_response/figures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/constants.h"

namespace hydroscope {
namespace {

constexpr double kRisen = 0.9;  // of the step
// 1 / w0, times the damping beyond 1: finer than any swing of the step response.
constexpr double kStepStride = 0.05;
constexpr double kCritical = 1e-6;                  // so near a damping of 1 the two poles are one
constexpr double kFurther = 1.1, kFurthest = 1000;  // of f0: where the phase is looked for
constexpr int kHalvings = 100;

/// Where `excess` turns positive between `low` and `high`.
template <typename Excess>
double Root(double low, double high, Excess excess) {
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (low + high) / 2;
    (excess(middle) < 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

double BandwidthOf(double f0, double damping) {
  const double b = 1 - 2 * damping * damping;
  return f0 * std::sqrt(b + std::sqrt(b * b + 1));
}

double Phase90Of(double f0, double damping, double dead_time) {
  const auto excess = [&](double f) {
    const double r = f / f0;
    return std::atan2(2 * damping * r, 1 - r * r) + kTwoPi * f * dead_time - std::numbers::pi / 2;
  };
  double high = f0;
  while (excess(high) < 0 && high < kFurthest * f0) high *= kFurther;
  return Root(0, high, excess);
}

double RiseTime90Of(double f0, double damping, double dead_time) {
  const auto step = [damping](double x) {  // x = w0 t
    if (std::abs(damping - 1) < kCritical) return 1 - std::exp(-x) * (1 + x);
    if (damping < 1) {
      const double d = std::sqrt(1 - damping * damping);
      return 1 - std::exp(-damping * x) * (std::cos(d * x) + damping / d * std::sin(d * x));
    }
    const double root = std::sqrt(damping * damping - 1), fast = damping + root, slow = 1 / fast;
    return 1 - (fast * std::exp(-slow * x) - slow * std::exp(-fast * x)) / (fast - slow);
  };
  const double stride = kStepStride * std::max(1.0, damping);
  double high = 0;
  while (step(high) < kRisen) high += stride;
  const double risen = Root(std::max(0.0, high - stride), high, [&](double x) { return step(x) - kRisen; });
  return risen / (kTwoPi * f0) + dead_time;
}

}  // namespace hydroscope
