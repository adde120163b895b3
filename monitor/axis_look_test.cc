// AxisMonitor::Look: the same answer as for those who judge, and nothing is written.
#include "monitor/press_monitor_fixture.h"
#include "monitor/rules_for.h"

namespace hydroscope {
namespace {

using namespace press_monitor_test;
using testing::HasSubstr;

class AxisLookTest : public PressMonitorTest {
 protected:
  /// Health of the left axis as somebody who only reads sees it, with these rules.
  Result<Health> Look(const drift::RuleBook& rules) {
    auto database = Database::OpenReadOnly(DatabasePath()).value();
    auto journal = AlarmJournal::OpenReadOnly(AlarmJournal::PathFor(DatabasePath())).value();
    Machine left = machine_;
    left.name = "press/left";
    AxisMonitor axis(left, BuildModel(left).value(), rules, database, DatabasePath(), ids_[0], journal);
    if (const Status looked = axis.Look(); !looked) return tl::unexpected(looked.error());
    return axis.JudgedHealth();
  }
  drift::RuleBook Rules() { return RulesFor((folder_ / "press.toml").string(), machine_).value(); }
  /// What the one who judges says, with the rows of the journal before anybody looks.
  Health Judge() {
    const auto press = Open();
    EXPECT_OK(press->CatchUp(1000));
    rows_ = Journal().size();
    return press->axis(0).JudgedHealth();
  }
  void ExpectSame(const Health& judged) {
    const auto looked = Look(Rules());
    ASSERT_TRUE(looked.has_value()) << looked.error().text;
    EXPECT_EQ(looked->letter(), judged.letter());
    EXPECT_EQ(looked->text, judged.text);
    EXPECT_EQ(looked->learned, judged.learned);
    EXPECT_EQ(looked->needed, judged.needed);
    EXPECT_EQ(Journal().size(), rows_);
  }

  std::size_t rows_ = 0;
};

TEST_F(AxisLookTest, WhileItLearnsTheStrokesAreCountedAndNothingIsGood) {
  auto few = Healthy();
  few.resize(19);
  Store(0, few);
  const Health judged = Judge();
  EXPECT_EQ(judged.letter(), 'C');
  EXPECT_THAT(judged.text, HasSubstr("19 of 100"));
  ExpectSame(judged);
}

TEST_F(AxisLookTest, HowManyStrokesLearningNeedsIsWhatTheOneWhoJudgesHasRecordedWhateverRulesTheReaderHas) {
  auto few = Healthy();
  few.resize(19);
  Store(0, few);
  Judge();
  const auto looked = Look(RulesFor("", machine_).value());
  ASSERT_TRUE(looked.has_value()) << looked.error().text;
  EXPECT_EQ(looked->learned, 19);
  EXPECT_EQ(looked->needed, 100) << "the built-in rules need 1500";
}

TEST_F(AxisLookTest, AJudgedAxisIsGood) {
  Store(0, Healthy());
  const Health judged = Judge();
  EXPECT_EQ(judged.letter(), '-');
  ExpectSame(judged);
}

TEST_F(AxisLookTest, AnAlarmThatStandsIsTold) {
  Store(0, Healthy());
  Store(0, Leaking());
  const Health judged = Judge();
  EXPECT_EQ(judged.letter(), 'M');
  ExpectSame(judged);
}

TEST_F(AxisLookTest, ColdStrokesAtTheEndAreNotGood) {
  Store(0, Healthy());
  auto cold = Healthy();
  cold.resize(12);
  for (StrokeRecord& stroke : cold) stroke.summary.oil_temperature = 280;
  Store(0, cold);
  const Health judged = Judge();
  EXPECT_EQ(judged.letter(), 'C');
  ExpectSame(judged);
}

TEST_F(AxisLookTest, StrokesThatNobodyJudgedAreNotGood) {
  Store(0, Healthy());
  EXPECT_EQ(Judge().letter(), '-');
  Store(0, Leaking());
  const auto looked = Look(Rules());
  ASSERT_TRUE(looked.has_value()) << looked.error().text;
  EXPECT_EQ(looked->letter(), 'C');
  EXPECT_EQ(looked->reason, HealthReason::kStrokesNotJudged);
  EXPECT_THAT(looked->text, HasSubstr("strokes are stored that nobody has judged"));
}

TEST_F(AxisLookTest, OtherRulesThanItWasJudgedByAreAnError) {
  Store(0, Healthy());
  Judge();
  drift::RuleBook other = Rules();
  std::erase_if(other.watches,
                [](const drift::WatchSpec& watch) { return watch.quantity == "internal_leakage"; });
  const auto looked = Look(other);
  ASSERT_FALSE(looked.has_value());
  EXPECT_THAT(looked.error().text, HasSubstr("--machine"));
}

TEST_F(AxisLookTest, WhileNothingChangesTheJournalIsNotReadAgain) {
  Store(0, Healthy());
  Judge();
  auto database = Database::Open(DatabasePath()).value();
  auto journal = AlarmJournal::Open(AlarmJournal::PathFor(DatabasePath())).value();
  const drift::RuleBook rules = Rules();
  Machine left = machine_;
  left.name = "press/left";
  AxisMonitor axis(left, BuildModel(left).value(), rules, database, DatabasePath(), ids_[0], journal);
  EXPECT_OK(axis.CatchUp(1001));
  const std::int64_t before = journal.PagesAsked();
  for (int round = 0; round < 10; ++round) EXPECT_OK(axis.CatchUp(1002));
  EXPECT_LE(journal.PagesAsked() - before, 10) << "no more than whether somebody wrote";
  const auto other = Open();
  AlarmCondition condition;
  condition.severity = AlarmSeverity::kWarning;
  EXPECT_OK(other->axis(0).Observe("somebody_elses", {1, 1, 0, false}, condition, 1003));
  EXPECT_OK(axis.CatchUp(1004));
  EXPECT_THAT(Standing(axis), testing::ElementsAre(HasSubstr("somebody_elses")));
}

}  // namespace
}  // namespace hydroscope
