#include "monitor/press_monitor.h"

#include <SQLiteCpp/SQLiteCpp.h>

#include "monitor/press_monitor_fixture.h"
#include "report/drift_report.h"

namespace hydroscope {
namespace {

using namespace press_monitor_test;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(PressMonitorTest, ALeakOfOneAxisIsItsAlarmWithTheStrokesAndTheExplanation) {
  Store(0, Healthy());
  Store(1, Healthy());
  const auto press = Open();
  ASSERT_OK(press->CatchUp(1000));
  EXPECT_EQ(press->axis(0).Health(), '-');
  Store(0, Leaking());
  ASSERT_OK(press->CatchUp(2000));
  EXPECT_THAT(Standing(press->axis(0)), testing::ElementsAre("UNACK internal_leakage"));
  EXPECT_THAT(Standing(press->axis(1)), IsEmpty());
  EXPECT_EQ(press->axis(0).Health(), 'M');
  ASSERT_EQ(press->axis(0).monitor()->findings().size(), 1u);
  const drift::DriftFinding& finding = press->axis(0).monitor()->findings().front();
  EXPECT_NEAR(static_cast<double>(finding.since.last_before + 1), static_cast<double>(Healthy().size()), 10);
  EXPECT_NEAR(finding.parts.front().size, 3e-12, 0.6e-12);
  EXPECT_THAT(finding.compared.text.english, HasSubstr("nearest: internal_leakage (G = "));
  EXPECT_THAT(finding.compared.text.english, HasSubstr("error on strokes left out"));
  for (const AlarmState& alarm : press->axis(0).alarms())
    if (alarm.id == "internal_leakage") {
      EXPECT_THAT(alarm.text, HasSubstr(finding.compared.text.english));
    }
}

TEST_F(PressMonitorTest, AHistoryOfAnotherModelIsNotReadWhileItLearns) {
  const auto few = std::vector<StrokeRecord>(Healthy().begin(), Healthy().begin() + 5);
  auto columns = BuildModel(machine_).value()->ColumnNames();
  columns.emplace_back("another");
  const int other = database_->PutModelVersion(ids_[0], {2, "# another", columns}).value();
  Store(0, few);
  // They are of the other model now, and who reads their Grams fails.
  SQLite::Database(DatabasePath(), SQLite::OPEN_READWRITE)
      .exec(fmt::format(
          "UPDATE run SET model_version = {1} WHERE id = {0}; UPDATE gram SET gram = x'00' WHERE run = {0}",
          runs_[0], other));
  stored_[0] = 0;  // of the next run
  const auto press = Open();
  ASSERT_OK(press->CatchUp(1000));
  runs_[0] = database_->BeginRun(ids_[0], 1, "live", "live/own").value().id;
  Store(0, Healthy());
  ASSERT_OK(press->CatchUp(1001));
  EXPECT_NE(press->axis(0).monitor(), nullptr) << "those of its own are learned from";
}

TEST_F(PressMonitorTest, TheReportShowsWhatWasLearnedAndWhatMovedFirst) {
  const auto press = Open();
  Store(0, Leaking());  // too few to learn from
  ASSERT_OK(press->CatchUp(900));
  EXPECT_THAT(DriftSection(press->axis(0), 100).value(), HasSubstr("being learned"));
  EXPECT_EQ(AlarmsBox({}, press->axis(0).alarms()), "");
  Store(1, Healthy());
  Store(1, Leaking());
  ASSERT_OK(press->CatchUp(1000));
  const std::string section = DriftSection(press->axis(1), 100).value();
  EXPECT_THAT(section, HasSubstr("Reference 1, learned from strokes 0 to 99"));
  EXPECT_LT(section.find("internal_leakage, deviation"), section.find("K′, deviation"));
  for (const char* curve : {"bulk modulus", "valve flow", "dead volume"})
    EXPECT_THAT(section, HasSubstr(curve));
  EXPECT_THAT(AlarmsBox({}, press->axis(1).alarms()), HasSubstr("nearest: internal_leakage (G = "));
}

/// The same strokes as if the oil had never been compressed: dead volume and bulk modulus are not to be told.
std::vector<StrokeRecord> WithoutCompression(std::vector<StrokeRecord> strokes) {
  constexpr int kVolumeColumn = 1;
  for (StrokeRecord& stroke : strokes)
    for (SymmetricMatrix* sums : {&stroke.gram.integral, &stroke.gram.noise})
      for (int j = 0; j < sums->dimension(); ++j) (*sums)(kVolumeColumn, j) = 0;
  return strokes;
}

TEST_F(PressMonitorTest, StrokesThatDoNotTellTheParametersApartMakeRoomForOthers) {
  const std::vector<StrokeRecord> healthy = Healthy();
  const std::vector<StrokeRecord> blind(healthy.begin(), healthy.begin() + 99);
  Store(0, WithoutCompression(blind));
  const auto press = Open();
  ASSERT_OK(press->CatchUp(900));
  EXPECT_EQ(press->axis(0).monitor(), nullptr) << "too few strokes";
  Store(0, WithoutCompression({healthy.front(), healthy.front()}));
  ASSERT_OK(press->CatchUp(1000));
  EXPECT_EQ(press->axis(0).monitor(), nullptr) << "strokes 0 ... 99 tell nothing, 50 ... 100 are kept";
  EXPECT_EQ(press->axis(0).Health(), 'C');
  Store(0, {healthy.begin(), healthy.begin() + 49});
  ASSERT_OK(press->CatchUp(2000));
  ASSERT_NE(press->axis(0).monitor(), nullptr);
  EXPECT_EQ(press->axis(0).monitor()->reference().first_sequence(), 50);
  EXPECT_EQ(press->axis(0).monitor()->reference().last_sequence(), 149);
  EXPECT_THAT(Events(), testing::ElementsAre(HasSubstr("reference_learned"), HasSubstr("doubtful_reference")))
      << "one model does not describe both halves";
}

TEST_F(PressMonitorTest, WhatAllAxesShowTogetherIsToldOnceByThePress) {
  for (int a = 0; a < 2; ++a) Store(a, Healthy());
  for (int a = 0; a < 2; ++a) Store(a, Clogged());
  const auto press = Open();
  ASSERT_OK(press->CatchUp(1000));
  ASSERT_EQ(press->alarms().size(), 1u);
  EXPECT_EQ(press->alarms().front().id, "all_valves");
  EXPECT_TRUE(press->alarms().front().active);
  for (int a = 0; a < 2; ++a)
    EXPECT_THAT(Standing(press->axis(a)), testing::ElementsAre("DSUPR clogged_valve"));
  const std::size_t rows = Journal().size();
  ASSERT_OK(press->CatchUp(1001));
  EXPECT_EQ(Journal().size(), rows) << "nothing new, nothing written";
}

/// The strokes of both axes come side by side as in the live service, in the other test one axis after the
/// other as in a replay; each life of the monitor judges what has come.
TEST_F(PressMonitorTest, AxesJudgedOneAfterTheOtherSayTheSameAsSideBySide) {
  std::vector<StrokeRecord> all = Healthy();
  all.insert(all.end(), Clogged().begin(), Clogged().end());
  const auto begin_anew = [&] {
    for (const char* end : {"", "-wal", "-shm"})
      std::filesystem::remove(AlarmJournal::PathFor(DatabasePath()) + end);
  };
  for (std::size_t from = 0; from < all.size(); from += 29)
    for (int a = 0; a < 2; ++a) {
      const std::size_t to = std::min(all.size(), from + 29);
      Store(a, {all.begin() + static_cast<long>(from), all.begin() + static_cast<long>(to)});
      ASSERT_OK(Open()->CatchUp(1000 + static_cast<double>(from)));
    }
  const auto told_of = [&](const std::string& machine) {
    std::vector<std::string> told;
    for (const JournalRow& row : Journal())
      if (row.machine == machine && row.event.event != "suppressed")
        told.push_back(
            fmt::format("{} {} {} {}", row.event.alarm, row.event.event, row.event.stroke, row.event.text));
    return told;
  };
  const auto side_by_side = std::vector{told_of("press"), told_of("press/left"), told_of("press/right")};
  ASSERT_THAT(side_by_side[0], testing::ElementsAre(HasSubstr("all_valves raised")));
  const AxisContent left =
      AlarmJournal::Open(AlarmJournal::PathFor(DatabasePath())).value().Axis("press/left").value();
  begin_anew();
  for (const char* only : {"right", "left"}) {
    std::vector<Machine> axes = MachinesOfAxes(machine_);
    std::erase_if(axes,
                  [&](const Machine& m) { return only == std::string("right") && !m.name.ends_with(only); });
    auto press = PressMonitor::Create((folder_ / "press.toml").string(), machine_.name, axes, DatabasePath());
    ASSERT_OK(press);
    ASSERT_OK((*press)->CatchUp(5000));
  }
  EXPECT_EQ((std::vector{told_of("press"), told_of("press/left"), told_of("press/right")}), side_by_side);
  const AxisContent again =
      AlarmJournal::Open(AlarmJournal::PathFor(DatabasePath())).value().Axis("press/left").value();
  ASSERT_EQ(again.alarms.size(), left.alarms.size());
  for (std::size_t k = 0; k < left.alarms.size(); ++k) {
    EXPECT_STREQ(StateName(again.alarms[k]), StateName(left.alarms[k])) << left.alarms[k].id;
    EXPECT_EQ(again.alarms[k].suppressed, left.alarms[k].suppressed);
  }
}

TEST_F(PressMonitorTest, WhatCameAndWentTogetherIsToldThoughOneAxisIsJudgedLater) {
  for (int a = 0; a < 2; ++a)
    for (const auto* strokes : {&Healthy(), &Clogged(), &Healthy()}) Store(a, *strokes);
  std::vector<Machine> axes = MachinesOfAxes(machine_);
  auto left =
      PressMonitor::Create((folder_ / "press.toml").string(), machine_.name, {axes[0]}, DatabasePath());
  ASSERT_OK((*left)->CatchUp(1000));
  EXPECT_THAT(Standing((*left)->axis(0)), testing::ElementsAre("RTNUN clogged_valve"));
  const auto press = Open();
  ASSERT_OK(press->CatchUp(2000));
  ASSERT_EQ(press->alarms().size(), 1u);
  EXPECT_STREQ(StateName(press->alarms().front()), "RTNUN");
  std::vector<std::string> together;
  for (const JournalRow& row : Journal())
    if (row.machine == "press") together.push_back(row.event.event);
  EXPECT_THAT(together, testing::ElementsAre("raised", "cleared"));
}

TEST_F(PressMonitorTest, WhileNothingComesNextToNothingIsAskedFor) {
  for (int a = 0; a < 2; ++a) Store(a, Healthy());
  const auto press = Open();
  for (int times = 0; times < 2; ++times)
    ASSERT_OK(press->CatchUp(1000));  // the second sees what the first wrote
  const auto pages_asked_behind = [&](const std::string& written) {
    EXPECT_TRUE(Database::Open(DatabasePath()).value().MachineId(written));
    const std::int64_t before = press->PagesAsked();
    EXPECT_OK(press->CatchUp(1000));
    return press->PagesAsked() - before;
  };
  EXPECT_LE(pages_asked_behind("another"), 10);
  Store(1, Clogged());
  EXPECT_GT(pages_asked_behind("one more"), 50);
  EXPECT_THAT(Standing(press->axis(1)), testing::Not(testing::IsEmpty()));
}

TEST_F(PressMonitorTest, ARestartNeitherLiftsNorRepeatsASuppression) {
  for (int a = 0; a < 2; ++a) Store(a, Healthy());
  for (int a = 0; a < 2; ++a) Store(a, Clogged());
  ASSERT_OK(Open()->CatchUp(1000));
  const std::size_t rows = Journal().size();
  Store(0, {Clogged().front()});
  ASSERT_OK(Open()->CatchUp(2000));
  EXPECT_EQ(Journal().size(), rows) << testing::PrintToString(Events());
}

TEST_F(PressMonitorTest, AShelfOfThePressAlarmEnds) {
  for (int a = 0; a < 2; ++a) Store(a, Healthy());
  for (int a = 0; a < 2; ++a) Store(a, Clogged());
  const auto press = Open();
  ASSERT_OK(press->CatchUp(1000));
  auto journal = AlarmJournal::Open(AlarmJournal::PathFor(DatabasePath())).value();
  ASSERT_OK(journal.Change("press", 1001, [](AxisContent& content) -> Status {
    content.Append(alarm_machine::Shelve(content.Alarm("all_valves"), 1500, {"anna", ""}, {.wall = 1001}));
    return {};
  }));
  ASSERT_OK(press->CatchUp(1400));
  ASSERT_OK(press->Tick(1400));
  EXPECT_STREQ(StateName(press->alarms().front()), "SHLVD");
  ASSERT_OK(press->Tick(1501));
  EXPECT_STREQ(StateName(press->alarms().front()), "UNACK");
}

TEST_F(PressMonitorTest, OneAxisAloneIsNoCommonCause) {
  for (int a = 0; a < 2; ++a) Store(a, Healthy());
  Store(0, Clogged());
  const auto press = Open();
  ASSERT_OK(press->CatchUp(1000));
  EXPECT_THAT(press->alarms(), IsEmpty());
  EXPECT_THAT(Standing(press->axis(0)), testing::ElementsAre("UNACK clogged_valve"));
}

TEST_F(PressMonitorTest, ManyLivesJudgeAsOne) {
  Store(0, Healthy());
  Store(0, Leaking());
  {
    const auto press = Open();
    ASSERT_OK(press->CatchUp(1000));
  }
  const std::vector<std::string> once = Events();
  std::filesystem::remove(AlarmJournal::PathFor(DatabasePath()));
  std::filesystem::remove(AlarmJournal::PathFor(DatabasePath()) + "-wal");
  std::filesystem::remove(AlarmJournal::PathFor(DatabasePath()) + "-shm");
  // The other axis gets the same strokes piece by piece, with a new life of the monitor for each.
  std::vector<StrokeRecord> all = Healthy();
  all.insert(all.end(), Leaking().begin(), Leaking().end());
  for (std::size_t from = 0; from < all.size(); from += 37) {
    const std::size_t to = std::min(all.size(), from + 37);
    std::vector<StrokeRecord> piece(all.begin() + static_cast<long>(from),
                                    all.begin() + static_cast<long>(to));
    for (StrokeRecord& stroke : piece) stroke.summary.begin = stroke.summary.end = 0;
    std::int64_t index = static_cast<std::int64_t>(from);
    for (StrokeRecord& stroke : piece) stroke.summary.index = index++;
    ASSERT_OK(database_->StoreStrokes(runs_[1], piece));
    const auto press = Open();
    ASSERT_OK(press->CatchUp(1000 + static_cast<double>(from)));
  }
  std::vector<std::string> pieces, expected;
  for (const std::string& event : Events())
    if (event.starts_with("press/right")) pieces.push_back(event.substr(12));
  for (const std::string& event : once)
    if (event.starts_with("press/left")) expected.push_back(event.substr(11));
  EXPECT_THAT(pieces, testing::ElementsAreArray(expected));
}

TEST_F(PressMonitorTest, AReferenceLearnedByCommandIsTakenOverByARunningMonitor) {
  std::string rules = kRules;
  rules.replace(rules.find("automatic"), 9, "command");
  Write("press_rules.toml", rules);
  Store(0, Healthy());
  const auto press = Open();
  ASSERT_OK(press->CatchUp(1000));
  EXPECT_EQ(press->axis(0).monitor(), nullptr);
  EXPECT_EQ(press->axis(0).Health(), 'C');
  const auto command = Open();  // another process
  ASSERT_OK(command->axis(0).Learn(0, 1000, 2000, {"anna", "after the overhaul"}));
  ASSERT_OK(press->CatchUp(3000));
  ASSERT_NE(press->axis(0).monitor(), nullptr);
  EXPECT_EQ(press->axis(0).monitor()->reference().version(), 1);
  Store(0, Leaking());
  ASSERT_OK(press->CatchUp(4000));
  EXPECT_THAT(Standing(press->axis(0)), Contains("UNACK internal_leakage"));
  ASSERT_OK(command->axis(0).Learn(0, 120, 5000, {"anna", "once more"}));
  ASSERT_OK(press->CatchUp(6000));
  EXPECT_EQ(press->axis(0).monitor()->reference().version(), 2);
  EXPECT_THAT(Standing(press->axis(0)), Contains("RTNUN internal_leakage")) << "cleared by the new reference";
}

TEST_F(PressMonitorTest, TooFewStrokesCannotBeLearned) {
  Store(0, Leaking());
  const auto press = Open();
  const Status learned = press->axis(0).Learn(0, 20, 1000, {});
  ASSERT_FALSE(learned.has_value());
  EXPECT_THAT(learned.error().text, HasSubstr("expected at least 100"));
  const Status none = press->axis(0).Learn(5000, 6000, 1000, {});
  ASSERT_FALSE(none.has_value());
  EXPECT_THAT(none.error().text, HasSubstr("none stored"));
}

TEST_F(PressMonitorTest, IdleSuppressesWhatIsNewButNoLostLinkAndLeavesWhatStands) {
  Store(0, Healthy());
  Store(0, Leaking());
  const auto press = Open();
  ASSERT_OK(press->CatchUp(1000));
  AxisMonitor& axis = press->axis(0);
  ASSERT_OK(axis.Observe("no_samples", {1, 1, 0, false}, std::nullopt, 1001));
  ASSERT_OK(axis.SetSuppression(kSuppressedIdle, true, 1002));
  EXPECT_THAT(Standing(axis), Contains("UNACK internal_leakage"));
  AlarmCondition silent;
  silent.value = 5;
  silent.limit = 2;
  silent.severity = AlarmSeverity::kSignalLoss;
  ASSERT_OK(axis.Observe("no_samples", {1, 1, 0, false}, silent, 1003));
  EXPECT_THAT(Standing(axis), Contains("UNACK no_samples"));
  EXPECT_EQ(axis.Health(), 'F');
  AlarmCondition advice = silent;
  advice.severity = AlarmSeverity::kAdvisory;
  ASSERT_OK(axis.Observe("advice", {1, 1, 0, false}, advice, 1003));
  EXPECT_THAT(Standing(axis), Contains("DSUPR advice"));
  ASSERT_OK(axis.SetSuppression(kSuppressedIdle, false, 1004));
  EXPECT_THAT(Standing(axis), Contains("UNACK advice"));
  ASSERT_OK(axis.Observe("no_samples", {1, 1, 0, false}, std::nullopt, 1005));
  EXPECT_THAT(Standing(axis), Contains("RTNUN no_samples"));
}

ValveCheckRecord Check(double f0, const char* outcome = "measured") {
  ValveCheckRecord record{.outcome = outcome, .detail = "", .check = {}};
  record.check.natural_frequency = {f0, 0.2};
  record.check.damping = {0.67, 0.002};
  record.check.dead_time = {1e-3, 1e-5};
  record.check.oil_temperature = 313;
  return record;
}

TEST_F(PressMonitorTest, AValveCheckRaisesAndTheNextGoodOneClears) {
  const auto press = Open();
  for (int k = 0; k < 5; ++k) ASSERT_OK(database_->AddValveCheck(ids_[0], Check(184 + 0.1 * k)));
  ASSERT_OK(database_->AddValveCheck(ids_[0], Check(100, "broken")));
  ASSERT_OK(press->CatchUp(1000));
  EXPECT_THAT(Standing(press->axis(0)), IsEmpty());
  ASSERT_OK(database_->AddValveCheck(ids_[0], Check(184 * 0.9)));
  ASSERT_OK(press->CatchUp(1001));
  EXPECT_THAT(Standing(press->axis(0)), testing::ElementsAre("UNACK slow_pilot_stage"));
  const auto again = Open();  // a restart judges no check twice
  ASSERT_OK(again->CatchUp(1002));
  EXPECT_THAT(Standing(again->axis(0)), testing::ElementsAre("UNACK slow_pilot_stage"));
  ASSERT_OK(database_->AddValveCheck(ids_[0], Check(184)));
  ASSERT_OK(again->CatchUp(1003));
  EXPECT_THAT(Standing(again->axis(0)), testing::ElementsAre("RTNUN slow_pilot_stage"));
}

}  // namespace
}  // namespace hydroscope
