#include "diagnosis/states/remainder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "models/machine.h"

namespace hydroscope {
namespace {

constexpr double kFlowSensor = 1e-3;  // V, noise

/// A valve behind a lag that opens wide in an eighth of the log alone, and sticks a little where it hardly opens, which the
/// model does not know: x' = a (k u + c u^3 - x).
Episode ValveLog(double sticks) {
  constexpr int kRows = 1600, kWideFrom = 620, kWideTo = 780, kSubsteps = 20;
  constexpr double kPeriod = 0.05, kRate = 5, kGain = 1, kCubic = 0.2, kNarrow = 0.1, kWide = 1;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  Episode episode;
  episode.signal.resize(kRows, 2);
  double x = 0;
  for (int row = 0; row < kRows; ++row) {
    const double t = kPeriod * row;
    const double swing =
        std::sin(2 * std::numbers::pi * 0.31 * t) + std::sin(2 * std::numbers::pi * 0.83 * t);
    const double u = swing * (row >= kWideFrom && row < kWideTo ? kWide : kNarrow);
    episode.time.push_back(t);
    episode.signal(row, 0) = u;
    episode.signal(row, 1) = x + kFlowSensor * normal(random);
    for (int k = 0; k < kSubsteps; ++k)
      x += kPeriod / kSubsteps * kRate * (kGain * u + kCubic * u * u * u - sticks * std::tanh(u / 0.02) - x);
  }
  return episode;
}

TEST(StateRemainder, WhatParametersDoThatOneGroupOfPiecesAloneTellsOfIsNotPredicted) {
  const auto machine = ParseMachine(R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "V" }
[states]
x = { ddt = "a*(k*u + c*u^3 - x)" }
[outputs]
y = "x"
[parameters]
a = { start = 4, min = 0.5, max = 50, unit = "1/s" }
k = { start = 1.2, min = 0.1, max = 10 }
c = { start = 0.1, min = 0, max = 10 }
)toml",
                                    "valve");
  ASSERT_TRUE(machine) << machine.error().text;
  const Episode episode = ValveLog(5e-3);
  const StateFit fit = FitStates(BuildStateModel(*machine, {}).value(), std::span(&episode, 1));
  ASSERT_TRUE(fit.solved()) << fit.failed.english;
  const StateRemainder left = RemainderOf(fit, std::span(&episode, 1));
  const double noise = kFlowSensor * kFlowSensor / (fit.noise[0] * fit.noise[0]);  // of the error's energy
  EXPECT_TRUE(left.structured);
  EXPECT_GT(left.energy, noise);
  EXPECT_GT(left.least_share, 0.3);
  EXPECT_LT(left.least_share, 1 - noise);
}

}  // namespace
}  // namespace hydroscope
