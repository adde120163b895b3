#include <gtest/gtest.h>

#include "estimation/states/fit.h"

namespace hydroscope {
namespace {

/// A mass with dry friction: x' = v, v' = u - F_c sign(v).
constexpr char kMassThatSticks[] = R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "V" }
[states]
x = { ddt = "v", initial = 0 }
v = { ddt = "u - F_c*sign(v)", initial = 1 }
[outputs]
y = "x"
[parameters]
F_c = { start = 1, min = 0.8, max = 2 }
)toml";

TEST(StateFit, SaysThatAJumpAtRestMakesStepsTooShort) {
  const auto machine = ParseMachine(kMassThatSticks, "mass.toml");
  ASSERT_TRUE(machine) << machine.error().text;
  const auto model = BuildStateModel(*machine, {});
  ASSERT_TRUE(model) << model.error().text;
  constexpr int kRows = 50;
  constexpr double kPeriod = 0.1, kForce = 0.5;  // less than the friction: the mass comes to rest after 2 s
  Episode episode;
  episode.signal = RowMatrix::Zero(kRows, 2);
  for (int row = 0; row < kRows; ++row) {
    episode.time.push_back(kPeriod * row);
    episode.signal(row, 0) = kForce;
  }
  const StateFit fit = FitStates(*model, std::span(&episode, 1));
  EXPECT_NE(fit.failed.english.find("tanh(v/v_0)"), std::string::npos) << fit.failed.english;
  EXPECT_EQ(fit.failed.english.find("runs away"), std::string::npos) << fit.failed.english;
}

}  // namespace
}  // namespace hydroscope
