#include "diagnosis/states/other_causes/missing_limit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "diagnosis/states/explain_states.h"
#include "models/machine.h"

namespace hydroscope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kTanksRows = 600, kTanksSubsteps = 40;
constexpr double kTanksPeriod = 4;  // s

Machine TwoTanks() {
  const auto machine = ParseMachine(R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "V" }
[states]
h_1 = { ddt = "pump*u - k1*sqrt(max(h_1, 0))", initial = "estimate", min = 0 }
h_2 = { ddt = "k1*sqrt(max(h_1, 0)) - k2*sqrt(max(h_2, 0))", initial = "y", min = 0 }
[outputs]
y = "h_2"
[parameters]
k1 = { start = 0.05, min = 0.005, max = 1 }
k2 = { start = 0.05, min = 0.005, max = 1 }
pump = { start = 0.05, min = 0.005, max = 1 }

[[effect]]
id = "overflow"
adds = { h_1 = "-c*max(h_1 - brim, 0)" }
parameters = { brim = { start = 9, min = 3, max = 15 }, c = { start = 1, min = 0.1, max = 10 } }

[[effect]]
id = "leak"
adds = { h_1 = "-l*h_1" }
parameters = { l = { start = 0.001, min = 0, max = 0.1 } }
)toml",
                                    "tanks");
  EXPECT_TRUE(machine) << machine.error().text;
  return *machine;
}

/// Two tanks; the first overflows at `brim`, the second is full at `full`, its sensor ends at `end`, before noise is added.
Episode Cascade(double brim, double full, double end) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  Episode episode;
  episode.signal.resize(kTanksRows, 2);
  double h1 = 5, h2 = 4;
  for (int row = 0; row < kTanksRows; ++row) {
    const double t = kTanksPeriod * row, step = kTanksPeriod / kTanksSubsteps;
    const double u = 3.3 + 1.3 * (std::sin(t / 85) + std::sin(t / 152 + 1) + 0.6 * std::sin(t / 41));
    episode.time.push_back(t);
    episode.signal(row, 0) = u;
    episode.signal(row, 1) = std::min(h2, end) + 0.03 * normal(random);
    for (int k = 0; k < kTanksSubsteps; ++k) {
      const double out = 0.055 * std::sqrt(h1);
      h1 = std::clamp(h1 + step * (0.045 * u - out), 0.0, brim);
      h2 = std::clamp(h2 + step * (out - 0.05 * std::sqrt(h2)), 0.0, full);
    }
  }
  return episode;
}

TEST(MissingLimit, AFullTankThatTheFileDoesNotKnowHidesNoOverflow) {
  const Episode episode = Cascade(10, 10, 100);
  const StatesExplanation x = ExplainStates(TwoTanks(), std::span(&episode, 1));
  EXPECT_EQ(x.verdict, Verdict::kNamed);
  EXPECT_THAT(x.set, ElementsAre("overflow"));
  ASSERT_FALSE(x.warnings.empty());
  EXPECT_THAT(x.warnings.front().english, HasSubstr("for h_2 in [states]"));
}

TEST(MissingLimit, ASensorThatEndsHidesNoOverflow) {
  const Episode episode = Cascade(10, 100, 9.5);
  const StatesExplanation x = ExplainStates(TwoTanks(), std::span(&episode, 1));
  EXPECT_EQ(x.verdict, Verdict::kNamed);
  EXPECT_THAT(x.set, ElementsAre("overflow"));
  ASSERT_FALSE(x.warnings.empty());
  EXPECT_THAT(x.warnings.front().english, HasSubstr("in [outputs]"));
}

TEST(MissingLimit, AloneItIsNoAllClear) {
  const Episode episode = Cascade(100, 10, 100);
  const StatesExplanation x = ExplainStates(TwoTanks(), std::span(&episode, 1));
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_THAT(x.set, ElementsAre());
  EXPECT_THAT(x.warnings.front().english, HasSubstr("for h_2 in [states]"));
}

TEST(MissingLimit, WhereNothingEndsThereIsNone) {
  const Episode episode = Cascade(10, 100, 100);
  const StatesExplanation x = ExplainStates(TwoTanks(), std::span(&episode, 1));
  EXPECT_THAT(x.set, ElementsAre("overflow"));
  EXPECT_TRUE(x.warnings.empty());
}

}  // namespace
}  // namespace hydroscope
