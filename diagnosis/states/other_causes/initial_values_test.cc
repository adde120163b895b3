#include "diagnosis/states/other_causes/initial_values.h"

#include <gtest/gtest.h>

#include <random>

#include "models/machine.h"

namespace hydroscope {
namespace {

/// A record of a pendulum under a force that is held for twenty rows, from a deflection with no speed.
Episode PendulumFrom(double deflection, unsigned seed) {
  constexpr int kRows = 400, kSubsteps = 20, kHeld = 20;
  constexpr double kPeriod = 0.05, kStep = kPeriod / kSubsteps, kSensor = 1e-3;  // s; s; noise
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Episode episode;
  episode.signal.resize(kRows, 2);
  double x = deflection, v = 0, force = 0;
  for (int row = 0; row < kRows; ++row) {
    if (row % kHeld == 0) force = normal(random);
    episode.time.push_back(kPeriod * row);
    episode.signal(row, 0) = force;
    episode.signal(row, 1) = x + kSensor * normal(random);
    for (int k = 0; k < kSubsteps; ++k) {
      v += kStep * (force - 9 * x - 0.3 * v);
      x += kStep * v;
    }
  }
  return episode;
}

StateFit PendulumFit(const Episode& episode, const std::string& initial) {
  const auto machine = ParseMachine(R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "1" }
y = { column = "y", unit = "1" }
[states]
x = { ddt = "v", initial = )toml" + initial +
                                        R"toml( }
v = { ddt = "u - k*x - d*v", initial = )toml" +
                                        initial + R"toml( }
[outputs]
y = "x"
[parameters]
k = { start = 8, min = 1, max = 100 }
d = { start = 1, min = 0.01, max = 10 }
)toml",
                                    "pendulum");
  EXPECT_TRUE(machine) << machine.error().text;
  return FitStates(BuildStateModel(*machine, {}).value(), std::span(&episode, 1));
}

TEST(InitialValues, OfARecordThatDoesNotBeginAtRestAreTold) {
  const Episode moving = PendulumFrom(1, 1);
  const auto other = FindOtherBeginning(PendulumFit(moving, "0"), std::span(&moving, 1));
  ASSERT_TRUE(other);
  EXPECT_LT(other->error, 0.1);
  EXPECT_EQ(other->states, (std::vector<std::string>{"x", "v"}));
  EXPECT_EQ(
      OtherBeginningText(*other, Told("moving.csv")).english.rfind("moving.csv does not seem to begin", 0),
      0U);
}

TEST(InitialValues, OfARecordHeldOutAreToldToo) {
  const Episode resting = PendulumFrom(0, 2), moving = PendulumFrom(1, 3);
  const StateFit fit = PendulumFit(resting, "0");
  const auto other = FindOtherBeginningHeldOut(fit, std::span(&moving, 1));
  ASSERT_TRUE(other);
  EXPECT_LT(other->error, 0.1);
}

TEST(InitialValues, ThatHoldOrAreEstimatedAreNotTold) {
  const Episode resting = PendulumFrom(0, 2), again = PendulumFrom(0, 3), moving = PendulumFrom(1, 1);
  const StateFit fit = PendulumFit(resting, "0");
  EXPECT_FALSE(FindOtherBeginning(fit, std::span(&resting, 1)));
  EXPECT_FALSE(FindOtherBeginningHeldOut(fit, std::span(&again, 1)));
  EXPECT_FALSE(FindOtherBeginning(PendulumFit(moving, "\"estimate\""), std::span(&moving, 1)));
}

}  // namespace
}  // namespace hydroscope
