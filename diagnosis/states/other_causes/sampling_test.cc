#include "diagnosis/states/other_causes/sampling.h"

#include <gtest/gtest.h>

#include "diagnosis/states/other_causes/lag_fixture.h"

namespace hydroscope {
namespace {

/// What is found of a lag whose machine file says `log` of how it was measured.
std::optional<OtherSampling> FoundOf(const LagLog& lag, const std::string& log,
                                     LeftBySampling left = LeftBySampling::kDoubt) {
  const Episode episode = LagEpisode(lag);
  const StateFit fit = FitStates(BuildStateModel(LagMachine(log), {}).value(), std::span(&episode, 1));
  EXPECT_TRUE(fit.solved()) << fit.failed.english;
  return FindOtherSampling(fit, std::span(&episode, 1), left);
}

constexpr const char *kZero = "hold = \"zero\"\n", *kLinear = "hold = \"linear\"\n",
                     *kSmooth = "hold = \"smooth\"\n";

TEST(Sampling, AnotherWayThatInputsMoveInIsFound) {
  const auto filtered = FoundOf({Filtered}, kLinear), stepped = FoundOf({Stepped}, kLinear);
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
  EXPECT_FALSE(FoundOf({Filtered}, kSmooth));
  EXPECT_FALSE(FoundOf({Stepped}, kZero));
}

TEST(Sampling, ALawThatIsMissingIsNotTakenForAnotherHold) {
  EXPECT_FALSE(FoundOf({Filtered, Hardening}, kSmooth));
  EXPECT_FALSE(FoundOf({Stepped, Hardening}, kZero));
}

/// Half a row between is what inputs on straight lines make of those that are held, and is not taken for it either way.
TEST(Sampling, HowMuchOlderOutputsAreThanInputsIsFound) {
  for (const double rows : {0.2, -0.3, 0.5, 1.4}) {
    for (const bool steps : {false, true}) {
      const auto found =
          FoundOf({steps ? Stepped : Filtered, Proportional, rows * kLagPeriod}, steps ? kZero : kSmooth);
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
  const auto found = FoundOf({Filtered, Proportional, -0.4 * kLagPeriod}, kLinear);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->hold, InputHold::kSmooth);
  EXPECT_NEAR(found->late_rows, -0.4, 0.02);
}

TEST(Sampling, WhereTheFileSaysHowOldOutputsAreNothingElseIsTold) {
  EXPECT_FALSE(
      FoundOf({Filtered, Proportional, 0.2 * kLagPeriod}, std::string(kSmooth) + "outputs_late = 0\n"));
  EXPECT_FALSE(
      FoundOf({Filtered, Proportional, 0.2 * kLagPeriod}, std::string(kSmooth) + "outputs_late = 0.01\n"));
}

/// Noise of the sensor covers most of what straight lines lose.
constexpr double kCovering = 0.008;

TEST(Sampling, AnotherHoldThatLeavesALittleLessIsFoundWhereItLeavesNoise) {
  for (const LeftBySampling left : {LeftBySampling::kNoise, LeftBySampling::kDoubt}) {
    const auto found = FoundOf({Filtered, Proportional, 0, kCovering}, kLinear, left);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->hold, InputHold::kSmooth);
    EXPECT_FALSE(found->is_late);
    EXPECT_GT(found->error, SamplingOptions().less_error);
  }
}

TEST(Sampling, WhereNoiseIsLeftNoOtherIsFound) {
  for (const unsigned seed : {1, 2, 3}) {
    EXPECT_FALSE(FoundOf({Filtered, Proportional, 0, kCovering, seed}, kSmooth, LeftBySampling::kNoise));
    EXPECT_FALSE(FoundOf({Stepped, Proportional, 0, kCovering, seed}, kZero, LeftBySampling::kNoise));
    EXPECT_FALSE(FoundOf({Filtered, Proportional, 0, kCovering, seed}, kSmooth));
  }
}

}  // namespace
}  // namespace hydroscope
