// Alarms name what was measured, and a cause as far as comparing strokes carries it.
#include "monitor/axis_alarms.h"
#include "monitor/learning_check.h"
#include "monitor/press_monitor_fixture.h"

namespace hydroscope {
namespace {

using namespace press_monitor_test;
using testing::Contains;
using testing::HasSubstr;

/// Strokes of an oil column that is softer at every pressure, by another oil, say: no effect of the library.
const std::vector<StrokeRecord>& Softer() {
  static const auto strokes = Simulate(220, 4, [](PressOptions& o) { o.machine.K *= 0.9; });
  return strokes;
}

const AlarmState& AlarmOf(const AxisMonitor& axis, const std::string& id) {
  for (const AlarmState& alarm : axis.alarms())
    if (alarm.id == id) return alarm;
  ADD_FAILURE() << "no alarm " << id;
  return axis.alarms().front();
}

TEST_F(PressMonitorTest, ASofterOilColumnIsToldAsMeasuredWithoutACause) {
  Write("press_rules.toml", ReadDefaultRules());
  Store(0, Healthy());
  Store(0, Softer());
  const auto press = Open();
  ASSERT_OK(press->CatchUp(1000));
  const AlarmState& alarm = AlarmOf(press->axis(0), "entrained_air");
  EXPECT_TRUE(alarm.active);
  EXPECT_THAT(alarm.text, HasSubstr("Oil column softer; K -"));
  EXPECT_EQ(CauseText(alarm.cause), "not known");
  EXPECT_THAT(alarm.text, HasSubstr("Cause: not known."));
  EXPECT_THAT(alarm.text, testing::Not(HasSubstr("Air in the oil. ")));
}

TEST_F(PressMonitorTest, ACauseIsToldAsFarAsComparingStrokesCarriesIt) {
  Store(0, Healthy());
  Store(0, Leaking());
  const auto press = Open();
  ASSERT_OK(press->CatchUp(1000));
  const AlarmState& alarm = AlarmOf(press->axis(0), "internal_leakage");
  EXPECT_THAT(alarm.cause.effects, Contains("internal_leakage"));
  EXPECT_THAT(alarm.cause.effects, Contains("supply_leakage")) << "looks the same and could not be tried";
  EXPECT_EQ(alarm.cause.kind, CauseKind::kNotProven) << alarm.text;
  EXPECT_EQ(alarm.words.finding.english, "Internal leakage");
  EXPECT_THAT(alarm.text, HasSubstr("Cause: " + CauseText(alarm.cause)));
  EXPECT_THAT(alarm.words.action.english,
              testing::StartsWith("The cause is not proven: no repair yet. To tell internal_leakage from "));
  EXPECT_THAT(alarm.words.action.english, HasSubstr("supply"));
  EXPECT_THAT(alarm.words.action.english, testing::Not(HasSubstr("seal")));
  const auto again = Open();  // from the journal
  ASSERT_OK(again->CatchUp(1001));
  EXPECT_EQ(AlarmOf(again->axis(0), "internal_leakage").cause, alarm.cause);
}

/// A pressure sensor that reads 5 bar less looks the same, of which alone stored strokes keep columns.
TEST_F(PressMonitorTest, ABackPressureIsNotToldAsAZeroErrorForItHasATwin) {
  Write("press_rules.toml", ReadDefaultRules());
  Store(0, Healthy());
  Store(0, Simulate(220, 4, [](PressOptions& o) { o.imperfections = {{"tank_pressure", 5e5, {}, ""}}; }));
  const auto press = Open();
  ASSERT_OK(press->CatchUp(1000));
  int compared = 0;
  for (const AlarmState& alarm : press->axis(0).alarms()) {
    EXPECT_THAT(alarm.text, testing::Not(HasSubstr("Zero error"))) << "it is titled after what is not proven";
    if (alarm.cause.kind == CauseKind::kNotSought) continue;
    ++compared;
    EXPECT_EQ(alarm.cause.kind, CauseKind::kNotProven) << alarm.text;
    EXPECT_THAT(alarm.cause.effects, testing::ElementsAre("pressure_offset", "tank_pressure")) << alarm.text;
    EXPECT_THAT(alarm.words.evidence.english, HasSubstr("not proven: tank_pressure looks the same"));
  }
  EXPECT_GT(compared, 0);
}

TEST_F(PressMonitorTest, ALeakThatWasLearnedIsToldAsADoubtfulReference) {
  Store(0, Leaking());
  Store(0, Leaking());
  Store(0, Leaking());
  const auto press = Open();
  ASSERT_OK(press->CatchUp(1000));
  ASSERT_NE(press->axis(0).monitor(), nullptr);
  const AlarmState& alarm = AlarmOf(press->axis(0), "doubtful_reference");
  EXPECT_TRUE(alarm.active);
  EXPECT_THAT(alarm.text, HasSubstr("leakage"));
  EXPECT_EQ(press->axis(0).Health(), 'M');
}

/// No effect of one size explains it.
TEST_F(PressMonitorTest, ALeakThatGrowsWhileItIsLearnedIsToldAsADoubtfulReference) {
  Store(0, Simulate(330, 1, [](PressOptions&) {}));
  for (int day = 0; day < 4; ++day)
    Store(0, Simulate(80, 20 + day, [&](PressOptions& o) {
            o.effects = {{"internal_leakage", 2e-12 + 1e-12 * day, {}}};
          }));
  const auto press = Open();
  ASSERT_OK(press->CatchUp(1000));
  ASSERT_NE(press->axis(0).monitor(), nullptr);
  const AlarmState& alarm = AlarmOf(press->axis(0), "doubtful_reference");
  EXPECT_TRUE(alarm.active);
  EXPECT_THAT(alarm.text, HasSubstr("they hold a change between strokes"));
  EXPECT_EQ(press->axis(0).Health(), 'M');
}

/// What the model misses may be the fault that is sought; a small error, or one that may be noise, is none.
TEST(LearningDoubts, AnUnknownDoesNotRefuseButMakesTheReferenceDoubtful) {
  using Kind = LearningDoubt::Kind;
  for (const bool minor : {false, true}) {
    const std::vector<LearningDoubt> doubts = {{Kind::kUnexplained, {"the model errs", ""}, minor}};
    EXPECT_FALSE(doubts[0].Refuses());
    AxisContent content;
    axis_alarms::JudgeReference(1, doubts, {}, content);
    EXPECT_EQ(content.alarms.size(), minor ? 0u : 1u);
  }
}

}  // namespace
}  // namespace hydroscope
