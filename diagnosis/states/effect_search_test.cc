#include "diagnosis/states/effect_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "models/machine.h"

namespace hydroscope {
namespace {

/// A level that a wind drives by the square of p; the sign of p shows in three short blows alone, and a fit that begins on the wrong
/// side stays there. With the effect, which no log needs, what the wind does grows with p on both sides.
constexpr const char* kLevelInTheWind = R"toml([log]
hold = "zero"
[signals]
wind = { column = "wind", unit = "1" }
blow = { column = "blow", unit = "1" }
y = { column = "y", unit = "1" }
[states]
x = { ddt = "p^2*wind + 0.13*p*blow - 5*x", initial = "estimate" }
[outputs]
y = "x"
[parameters]
p = { start = -1.2, min = -1.4, max = 2 }
[[effect]]
id = "leaning"
adds = { x = "3*p*wind" }
)toml";

/// Rows of 10 ms.
Episode LevelLog(double p) {
  constexpr int kRows = 2000, kApart = 500, kBlow = 20;
  constexpr double kPeriod = 0.01, kSensor = 0.02;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  Episode episode;
  episode.signal.resize(kRows, 3);
  double x = 0;
  for (int row = 0; row < kRows; ++row) {
    const double t = kPeriod * row, blow = row >= kApart && row % kApart < kBlow ? 1 : 0;
    double wind = 0;
    for (const double hertz : {0.7, 1.9, 3.1}) wind += std::sin(2 * std::numbers::pi * hertz * t + hertz);
    episode.time.push_back(t);
    episode.signal.row(row) << wind, blow, x + kSensor * normal(random);
    const double stays = std::exp(-5 * kPeriod);
    x = stays * x + (1 - stays) / 5 * (p * p * wind + 0.13 * p * blow);
  }
  return episode;
}

TEST(SearchEffects, AWrongMinimumOfTheModelAsItIsIsLeftWhereAnEffectThatIsNotNamedLeads) {
  const auto machine = ParseMachine(kLevelInTheWind, "level");
  ASSERT_TRUE(machine) << machine.error().text;
  const Episode episode = LevelLog(1);
  ExplainStatesOptions options;
  options.fit.starts = 0;
  const StatesExplanation x = SearchEffects(*machine, std::span(&episode, 1), 1, options);
  EXPECT_EQ(x.verdict, Verdict::kAdequate);
  ASSERT_TRUE(x.base.fit.solved());
  EXPECT_NEAR(x.base.fit.parameters[0], 1, 0.01);
}

}  // namespace
}  // namespace hydroscope
