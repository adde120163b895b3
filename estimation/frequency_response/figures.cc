#include "estimation/frequency_response/figures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/constants.h"

namespace hydroscope {
namespace {}  // namespace

double BandwidthOf(double f0, double damping) {
  const double b = 1 - 2 * damping * damping;
  return f0 * std::sqrt(b + std::sqrt(b * b + 1));
}

double Phase90Of(double f0, double damping, double dead_time) {
  const auto excess = [&](double f) {
    const double r = f / f0;
    return std::atan2(2 * damping * r, 1 - r * r) + kTwoPi * f * dead_time - std::numbers::pi / 2;
  };
  double low = 0, high = f0;
  while (excess(high) < 0 && high < 1000 * f0) high *= 1.1;
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (excess(middle) < 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

double RiseTime90Of(double f0, double damping, double dead_time) {
  const auto step = [damping](double x) {  // x = w0 t
    if (std::abs(damping - 1) < 1e-6) return 1 - std::exp(-x) * (1 + x);
    if (damping < 1) {
      const double d = std::sqrt(1 - damping * damping);
      return 1 - std::exp(-damping * x) * (std::cos(d * x) + damping / d * std::sin(d * x));
    }
    const double root = std::sqrt(damping * damping - 1), fast = damping + root, slow = 1 / fast;
    return 1 - (fast * std::exp(-slow * x) - slow * std::exp(-fast * x)) / (fast - slow);
  };
  constexpr double kRisen = 0.9;                        // of the step
  const double stride = 0.05 * std::max(1.0, damping);  // finer than any swing of the step response
  double high = 0;
  while (step(high) < kRisen) high += stride;
  double low = std::max(0.0, high - stride);
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (step(middle) < kRisen ? low : high) = middle;
  }
  return high / (kTwoPi * f0) + dead_time;
}

}  // namespace hydroscope
