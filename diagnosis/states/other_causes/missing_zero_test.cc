#include "diagnosis/states/other_causes/missing_zero.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "models/machine.h"

namespace hydroscope {
namespace {

/// A level with an outlet, read with a zero of 0.2 m and noise of 5 mm.
Episode LevelLog() {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Episode episode;
  episode.signal.resize(800, 2);
  double h = 1;
  for (int row = 0; row < 800; ++row) {
    const double t = 0.5 * row, u = 1 + 0.6 * std::sin(t / 7) + 0.3 * std::sin(t / 2.3);
    episode.time.push_back(t);
    episode.signal(row, 0) = u;
    episode.signal(row, 1) = h + 0.2 + 0.005 * normal(random);
    for (int step = 0; step < 10; ++step) h += 0.05 * (0.2 * u - 0.2 * std::sqrt(h));
  }
  return episode;
}

StateFit Fitted(const std::string& output, const std::string& parameters, const Episode& episode) {
  const auto machine = ParseMachine(R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "1" }
y = { column = "y", unit = "m" }
[states]
h = { ddt = "q*u - k*sqrt(max(h, 0))", initial = "y", min = 0, unit = "m" }
[outputs]
y = ")toml" + output +
                                        "\"\n[parameters]\nq = { start = 0.3, min = 0.05, max = 1 }\n"
                                        "k = { start = 0.3, min = 0.05, max = 1 }\n" +
                                        parameters,
                                    "level");
  EXPECT_TRUE(machine) << machine.error().text;
  return FitStates(*BuildStateModel(*machine, {}), std::span(&episode, 1));
}

TEST(MissingZero, ThatOfALevelSensorIsFound) {
  const Episode episode = LevelLog();
  const StateFit fit = Fitted("h", "", episode);
  const auto zeros = FindMissingZeros(fit, std::span(&episode, 1));
  ASSERT_TRUE(zeros);
  ASSERT_EQ(zeros->of.size(), 1u);
  EXPECT_NEAR(zeros->of[0].at, 0.2, 0.02);
  EXPECT_LT(zeros->error, 0.5);
  EXPECT_THAT(MissingZerosText(*zeros, fit.model->machine).english, testing::HasSubstr("mm in y)"));
}

TEST(MissingZero, WhereTheFileGivesOneThereIsNone) {
  const Episode episode = LevelLog();
  const StateFit fit = Fitted("h + y_0", "y_0 = { start = 0, min = -1, max = 1 }\n", episode);
  EXPECT_FALSE(FindMissingZeros(fit, std::span(&episode, 1)));
}

}  // namespace
}  // namespace hydroscope
