#include "diagnosis/states/other_causes/missing_zero.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "diagnosis/states/other_causes/level_fixture.h"

namespace hydroscope {
namespace {

StateFit Fitted(const Machine& machine, const Episode& episode) {
  return FitStates(*BuildStateModel(machine, {}), std::span(&episode, 1));
}

TEST(MissingZero, ThatOfALevelSensorIsFound) {
  const Episode episode = LevelWithZero();
  const StateFit fit = Fitted(LevelMachine("h", ""), episode);
  const auto zeros = FindMissingZeros(fit, std::span(&episode, 1));
  ASSERT_TRUE(zeros);
  ASSERT_EQ(zeros->of.size(), 1u);
  EXPECT_NEAR(zeros->of[0].at, 0.2, 0.02);
  EXPECT_LT(zeros->error, 0.5);
  EXPECT_THAT(MissingZerosText(*zeros, fit.model->machine).english, testing::HasSubstr("mm in y)"));
}

TEST(MissingZero, WhereTheFileGivesOneThereIsNone) {
  const Episode episode = LevelWithZero();
  const StateFit fit = Fitted(LevelMachine("h + y_0", "y_0 = { start = 0, min = -1, max = 1 }\n"), episode);
  EXPECT_FALSE(FindMissingZeros(fit, std::span(&episode, 1)));
}

}  // namespace
}  // namespace hydroscope
