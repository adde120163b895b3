#include "diagnosis/states/other_causes/sampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "models/machine.h"

namespace hydroscope {
namespace {

constexpr double kLagPeriod = 0.05, kLagRate = 4;  // s, 1/s
constexpr int kLagSubsteps = 50;                   // from a row to the next

/// Of an input at a time, s.
using LagInput = double (*)(double time);
/// Beside the lag's own rate, 1/s.
using LagLaw = double (*)(double x);

double Filtered(double time) {
  double u = 0;
  for (const double hertz : {0.9, 2.3, 3.9}) u += std::sin(2 * std::numbers::pi * hertz * time + hertz);
  return u;
}
double Stepped(double time) { return Filtered(kLagPeriod * std::floor(time / kLagPeriod + 1e-6)); }
double Proportional(double) { return 0; }
double Hardening(double x) { return -400 * x * x * x; }

/// What is found of a lag, x' = -k x + u, whose input moves in one way, where the machine file says another. Its output
/// is `late` s older than the input of its row. `log`: what the file says of that.
std::optional<OtherSampling> FoundOf(LagInput input, const std::string& stated, LagLaw law = Proportional,
                                     double late = 0, const std::string& log = "") {
  const auto machine = ParseMachine("[log]\n" + log + "hold = \"" + stated + R"toml("
[signals]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "V" }
[states]
x = { ddt = "-k*x + u", initial = "estimate" }
[outputs]
y = "x"
[parameters]
k = { start = 3, min = 0.1, max = 30, unit = "1/s" }
)toml",
                                    "lag");
  EXPECT_TRUE(machine) << machine.error().text;
  constexpr int kRows = 600;
  constexpr double kSensor = 1e-3;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Episode episode;
  episode.signal.resize(kRows, 2);
  double x = 0;
  for (int row = 0; row < kRows; ++row) {
    const double t = kLagPeriod * row, step = kLagPeriod / kLagSubsteps;
    episode.time.push_back(t);
    episode.signal(row, 0) = input(t);
    episode.signal(row, 1) = x + kSensor * normal(random);
    for (int k = 0; k < kLagSubsteps; ++k)
      x += step * (input(t - late + (k + 0.5) * step) - kLagRate * x + law(x)) / (1 + step * kLagRate / 2);
  }
  const StateFit fit = FitStates(BuildStateModel(*machine, {}).value(), std::span(&episode, 1));
  EXPECT_TRUE(fit.solved()) << fit.failed.english;
  return FindOtherSampling(fit, std::span(&episode, 1));
}

TEST(Sampling, AnotherWayThatInputsMoveInIsFound) {
  const auto filtered = FoundOf(Filtered, "linear"), stepped = FoundOf(Stepped, "linear");
  ASSERT_TRUE(filtered);
  EXPECT_EQ(filtered->hold, InputHold::kSmooth);
  EXPECT_LT(filtered->error, 0.3);
  EXPECT_FALSE(filtered->is_late);
  ASSERT_TRUE(stepped);
  EXPECT_EQ(stepped->hold, InputHold::kZero);
  EXPECT_LT(stepped->error, 0.3);
  EXPECT_FALSE(stepped->is_late);
}

TEST(Sampling, NoOtherIsToldOfWhereTheFileIsRight) {
  EXPECT_FALSE(FoundOf(Filtered, "smooth"));
  EXPECT_FALSE(FoundOf(Stepped, "zero"));
}

TEST(Sampling, ALawThatIsMissingIsNotTakenForAnotherHold) {
  EXPECT_FALSE(FoundOf(Filtered, "smooth", Hardening));
  EXPECT_FALSE(FoundOf(Stepped, "zero", Hardening));
}

/// Half a row between is what inputs on straight lines make of those that are held, and is not taken for it either way.
TEST(Sampling, HowMuchOlderOutputsAreThanInputsIsFound) {
  for (const double rows : {0.2, -0.3, 0.5, 1.4}) {
    for (const bool steps : {false, true}) {
      const auto found =
          FoundOf(steps ? Stepped : Filtered, steps ? "zero" : "smooth", Proportional, rows * kLagPeriod);
      ASSERT_TRUE(found) << rows << steps;
      EXPECT_TRUE(found->is_late) << rows << steps;
      EXPECT_FALSE(found->holds_otherwise) << rows << steps;
      EXPECT_NEAR(found->late_rows, rows, 0.02) << steps;
      EXPECT_NEAR(found->late, rows * kLagPeriod, 0.02 * kLagPeriod) << steps;
      EXPECT_LT(found->error, 0.5) << rows << steps;
    }
  }
}

TEST(Sampling, BothTheirAgeAndTheWayThatInputsMoveInAreFound) {
  const auto found = FoundOf(Filtered, "linear", Proportional, -0.4 * kLagPeriod);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->hold, InputHold::kSmooth);
  EXPECT_NEAR(found->late_rows, -0.4, 0.02);
}

TEST(Sampling, WhereTheFileSaysHowOldOutputsAreNothingElseIsTold) {
  EXPECT_FALSE(FoundOf(Filtered, "smooth", Proportional, 0.2 * kLagPeriod, "outputs_late = 0\n"));
  EXPECT_FALSE(FoundOf(Filtered, "smooth", Proportional, 0.2 * kLagPeriod, "outputs_late = 0.01\n"));
}

}  // namespace
}  // namespace hydroscope
