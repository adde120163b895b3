#include "workbench/states/measured_otherwise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "diagnosis/states/other_causes/lag_fixture.h"
#include "diagnosis/states/other_causes/level_fixture.h"
#include "workbench/states/states_log.h"
#include "workbench/states/states_output.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A zero bends the parameters so far that outputs which are newer than inputs seem to take half of the error away.
TEST(MeasuredOtherwise, AZeroThatLeavesLessThanAnotherAgeOfTheOutputsIsTaken) {
  EpisodeLog log;
  log.machine = LevelMachine("h", "");
  log.episodes = {LevelWithZero()};
  const auto fit = FitEpisodes(log);
  ASSERT_TRUE(fit) << fit.error().text;
  EXPECT_FALSE(fit->log.machine.log.outputs_late);
  ASSERT_TRUE(fit->zeros);
  EXPECT_NEAR(fit->zeros->of.front().at, 0.2, 0.02);
  EXPECT_FALSE(fit->left.structured);
  EXPECT_THAT(CompareText(*fit), HasSubstr("But for a constant"));
}

TEST(MeasuredOtherwise, ALogThatTheModelDescribesButForAConstantIsCalledSo) {
  EpisodeLog log;
  log.machine = LevelMachine("h",
                             "[[effect]]\nid = \"cubic\"\nadds = { h = \"-c*h*h*h\" }\n"
                             "parameters = { c = { start = 0.05, min = 0, max = 1 } }\n");
  log.episodes = {LevelWithZero()};
  const auto explained = ExplainReadEpisodes(log);
  ASSERT_TRUE(explained) << explained.error().text;
  EXPECT_TRUE(explained->only_zeros());
  const std::string text = ExplainText(*explained);
  EXPECT_THAT(text, HasSubstr("Verdict: unknown\nBut for a constant"));
  EXPECT_THAT(text, HasSubstr("Read y where its true value is known"));
  EXPECT_THAT(text, Not(HasSubstr("An error is there")));
  EXPECT_TRUE(ExplainJson(*explained)["only_zeros"].get<bool>());
}

constexpr const char* kCubic =
    "[[effect]]\nid = \"cubic\"\nadds = { x = \"-c*x*x*x\" }\nparameters = { c = { start = 1, min = 0, max = 100 } }\n";

/// Straight lines, which a file means that says nothing, leave a little more than noise.
TEST(MeasuredOtherwise, AHoldThatTheFileLeavesOpenIsTakenWhereItLeavesNoiseAlone) {
  EpisodeLog log;
  log.machine = LagMachine("", kCubic);
  log.episodes = {LagEpisode({.sensor = 0.008})};
  const auto explained = ExplainReadEpisodes(log);
  ASSERT_TRUE(explained) << explained.error().text;
  EXPECT_EQ(explained->explanation.verdict, Verdict::kAdequate);
  EXPECT_EQ(explained->log.machine.log.hold, InputHold::kSmooth);
  const auto fit = FitEpisodes(log);
  ASSERT_TRUE(fit) << fit.error().text;
  EXPECT_EQ(fit->log.machine.log.hold, InputHold::kSmooth);
  EXPECT_TRUE(fit->noise_alone());
}

TEST(MeasuredOtherwise, NoAllClearStandsWhereAnotherHoldThanTheOneStatedLeavesLess) {
  EpisodeLog log;
  log.machine = LagMachine("hold = \"smooth\"\n", kCubic);
  log.episodes = {LagEpisode({.input = OnLines, .sensor = 0.01})};
  const auto explained = ExplainReadEpisodes(log);
  ASSERT_TRUE(explained) << explained.error().text;
  EXPECT_EQ(explained->explanation.verdict, Verdict::kUnknown);
  EXPECT_EQ(explained->log.machine.log.hold, InputHold::kSmooth);
  EXPECT_THAT(ExplainText(*explained), HasSubstr("hold = \"linear\""));
  const auto fit = FitEpisodes(log);
  ASSERT_TRUE(fit) << fit.error().text;
  EXPECT_EQ(fit->log.machine.log.hold, InputHold::kSmooth);
  EXPECT_FALSE(fit->noise_alone());
  EXPECT_THAT(FitText(*fit), HasSubstr("hold = \"linear\""));
}

}  // namespace
}  // namespace hydroscope
