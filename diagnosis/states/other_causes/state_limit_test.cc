#include "diagnosis/states/other_causes/state_limit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "diagnosis/states/explain_states.h"
#include "models/machine.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kFillPeriod = 1;  // s
constexpr int kFillRows = 1500, kFillSubsteps = 50;

Machine TankThatMayHold(const std::string& most) {
  const auto machine = ParseMachine(R"toml([log]
hold = "zero"
[signals]
q = { column = "q", unit = "1" }
level = { column = "level", unit = "1" }
[states]
h = { ddt = "q - k*sqrt(max(h, 0))", initial = "estimate", min = 0, max = )toml" +
                                        most + R"toml( }
[outputs]
level = "h"
[parameters]
k = { start = 0.1, min = 0.01, max = 1 }

[[effect]]
id = "offset"
adds = { level = "b" }
parameters = { b = { start = 0, min = -3, max = 3 } }

[[effect]]
id = "leak"
adds = { h = "-l*h" }
parameters = { l = { start = 0.001, min = 0, max = 0.1 } }
)toml",
                                    "tank");
  EXPECT_TRUE(machine) << machine.error().text;
  return *machine;
}

/// A tank that stops at `brim`, without a leak of 0.01 h or with it.
Episode Filled(double brim, double leak = 0) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Episode episode;
  episode.signal.resize(kFillRows, 2);
  double h = 4;
  for (int row = 0; row < kFillRows; ++row) {
    const double t = kFillPeriod * row, step = kFillPeriod / kFillSubsteps;
    const double q = 0.2 + 0.06 * (std::sin(t / 31) + std::sin(t / 57 + 1));
    episode.time.push_back(t);
    episode.signal(row, 0) = q;
    episode.signal(row, 1) = h + 0.005 * normal(random);
    for (int k = 0; k < kFillSubsteps; ++k)
      h = std::clamp(h + step * (q - 0.1 * std::sqrt(h) - leak * h), 0.0, brim);
  }
  return episode;
}

TEST(StateLimit, OneBelowWhatTheMachineReachesIsDoubtedAndNoEffectIsNamedForIt) {
  const Episode episode = Filled(100);
  const double highest = episode.signal.col(1).maxCoeff();
  const StatesExplanation x =
      ExplainStates(TankThatMayHold(std::to_string(0.7 * highest)), std::span(&episode, 1));
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_THAT(x.set, IsEmpty());
  ASSERT_FALSE(x.warnings.empty());
  EXPECT_THAT(x.warnings.back().english, HasSubstr("h stands at its limit max"));
}

TEST(StateLimit, OneThatTheMachineReallyHasIsNot) {
  const Episode leaks = Filled(4.2, 0.01);
  const StatesExplanation x = ExplainStates(TankThatMayHold("4.2"), std::span(&leaks, 1));
  EXPECT_THAT(x.set, testing::ElementsAre("leak"));
  const Episode tight = Filled(4.2);
  EXPECT_EQ(ExplainStates(TankThatMayHold("4.2"), std::span(&tight, 1)).verdict, Verdict::kAdequate);
}

}  // namespace
}  // namespace hydroscope
