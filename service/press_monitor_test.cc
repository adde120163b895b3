#include "service/press_monitor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/expect_ok.h"
#include "service/benchmarks/simulated_strokes.h"
#include "service/drift_report.h"

namespace hydroscope {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

const char* const kMachine = R"toml(
[machine]
name = "press"
model = "die_cushion"
[live]
grid_period = 0.002
axes = ["left", "right"]
[live.dds]
[signals]
p_A = { dds = "{axis}/p_A", unit = "Pa" }
p_B = { dds = "{axis}/p_B", unit = "Pa", required = false }
p_0 = { dds = "{axis}/p_0", unit = "Pa", required = false }
z   = { dds = "{axis}/z", unit = "m" }
y_v = { dds = "{axis}/y_v", unit = "1" }
U_v = { dds = "{axis}/U_v", unit = "V", stuck_time = 0, required = false }
T_oil = { dds = "{axis}/T_oil", unit = "K", stuck_time = 0, required = false }
[geometry]
A_A = 0.0125
dp_nom = { value = 35, unit = "bar" }
p_t = 0
[gate]
conditions = { y_v = { min = 0.04 }, "ddt(z)" = { max = -0.004, unit = "m/s" } }
stroke_gap = 0.25
min_stroke = 0.3
)toml";

const char* const kRules = R"toml(
[monitor]
commissioning = 100
freeze = "automatic"
minimum_temperature = 22
warn_delay = 5
clear_delay = 30
deadband = 2
[watch]
K    = { change = 0.05, alarm_change = 0.25 }
V0   = { change = 0.05, alarm_change = 0.25 }
Q_vn = { change = 0.015, alarm_change = 0.08 }
y_0  = { change = { value = 0.15, unit = "%" }, alarm_change = { value = 1, unit = "%" } }
internal_leakage = { change = { value = 0.4, unit = "l/min" }, alarm_change = { value = 4, unit = "l/min" }, at = { value = 200, unit = "bar" }, only_upwards = true }
f0     = { change = 0.04, alarm_change = 0.25 }
D      = { change = 0.1, alarm_change = 0.5 }
T_dead = { change = { value = 0.3, unit = "ms" }, alarm_change = { value = 2, unit = "ms" } }
[[rule]]
id = "clogged_valve"
name = "Clogged valve"
when = { Q_vn = "down" }
may = ["y_0"]
guidance = "Look at the filter."
[[rule]]
id = "internal_leakage"
name = "Internal leakage"
when = { internal_leakage = "up" }
may = ["y_0"]
guidance = "Look at the seal."
[[rule]]
id = "slow_pilot_stage"
name = "Slow pilot stage"
when = { f0 = "down" }
guidance = "Look at the pilot filter."
[[rule]]
id = "all_valves"
name = "All valves together"
when = { Q_vn = "any" }
may = ["y_0"]
axes = 2
guidance = "Look at the oil."
)toml";

/// Strokes of a simulated cushion with this fault.
std::vector<StrokeRecord> Simulate(double seconds, std::uint64_t seed,
                                   const std::function<void(PressOptions&)>& fault) {
  PressOptions options;
  options.seconds = seconds;
  options.seed = seed;
  options.oil_start = 303.15;
  options.oil_end = 318.15;
  fault(options);
  const auto machine = ParseMachine(kMachine, "press.toml");
  EXPECT_TRUE(machine.has_value()) << (machine ? "" : machine.error().text);
  auto log = StrokesOf(SimulatePress(options), *machine);
  EXPECT_TRUE(log.has_value());
  return log->strokes;
}

const std::vector<StrokeRecord>& Healthy() {
  static const auto strokes = Simulate(700, 1, [](PressOptions&) {});
  return strokes;
}
const std::vector<StrokeRecord>& Leaking() {
  static const auto strokes = Simulate(220, 2, [](PressOptions& o) {
    o.effects = {{"internal_leakage", 3e-12, {}}};
  });
  return strokes;
}
const std::vector<StrokeRecord>& Clogged() {
  static const auto strokes = Simulate(220, 3, [](PressOptions& o) { o.machine.Q_vn *= 0.95; });
  return strokes;
}

class PressMonitorTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("press_monitor_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    Write("press.toml", kMachine);
    Write("press_rules.toml", kRules);
    machine_ = ParseMachine(kMachine, "press.toml").value();
    database_.emplace(Database::Open(DatabasePath()).value());
    for (int a = 0; a < 2; ++a) {
      const std::int64_t id = database_->MachineId(AxisMachineName(machine_, a)).value();
      const auto columns = BuildModel(machine_).value()->ColumnNames();
      const int version = database_->PutModelVersion(id, {1, kMachine, columns}).value();
      runs_.push_back(database_->BeginRun(id, version, "live", fmt::format("live/{}", a)).value().id);
      ids_.push_back(id);
    }
    stored_.resize(2);
  }
  void TearDown() override {
    database_.reset();
    std::filesystem::remove_all(folder_);
  }

  std::string DatabasePath() const { return (folder_ / "press.db").string(); }
  void Write(const char* name, const std::string& text) { std::ofstream(folder_ / name) << text; }

  void Store(int axis, std::vector<StrokeRecord> strokes) {
    std::int64_t& index = stored_[static_cast<std::size_t>(axis)];
    for (StrokeRecord& stroke : strokes) {
      stroke.summary.begin += 1e4 * static_cast<double>(index);  // logs one after the other
      stroke.summary.end += 1e4 * static_cast<double>(index);
      stroke.summary.index = index++;
    }
    ASSERT_OK(database_->StoreStrokes(runs_[static_cast<std::size_t>(axis)], strokes));
  }

  std::unique_ptr<PressMonitor> Open() {
    auto press = PressMonitor::Create((folder_ / "press.toml").string(), machine_.name,
                                      MachinesOfAxes(machine_), DatabasePath());
    EXPECT_TRUE(press.has_value()) << (press ? "" : press.error().text);
    return std::move(*press);
  }

  std::vector<JournalRow> Journal() const {
    return AlarmJournal::Open(AlarmJournal::PathFor(DatabasePath())).value().Rows("").value();
  }
  std::vector<std::string> Events() const {
    std::vector<std::string> events;
    for (const JournalRow& row : Journal())
      events.push_back(
          fmt::format("{} {} {} {}", row.machine, row.event.alarm, row.event.event, row.event.stroke));
    return events;
  }

  std::filesystem::path folder_;
  Machine machine_;
  std::optional<Database> database_;
  std::vector<std::int64_t> runs_, ids_, stored_;
};

/// 24 strokes with a leak may not tell it from one to the outside: then both are named, the likelier one
/// first.
constexpr const char* kInternalLeakageAppeared =
    "appeared( and the strokes cannot tell which)?: internal_leakage";

std::vector<std::string> Standing(const AxisMonitor& axis) {
  std::vector<std::string> alarms;
  for (const AlarmState& alarm : axis.alarms())
    if (!AtRest(alarm)) alarms.push_back(std::string(StateName(alarm)) + " " + alarm.id);
  return alarms;
}

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
  EXPECT_THAT(finding.explanation, testing::ContainsRegex(kInternalLeakageAppeared));
  EXPECT_THAT(finding.explanation, HasSubstr("error on strokes left out"));
  for (const AlarmState& alarm : press->axis(0).alarms())
    if (alarm.id == "internal_leakage") {
      EXPECT_THAT(alarm.text, HasSubstr(finding.explanation));
    }
}

TEST_F(PressMonitorTest, TheReportShowsWhatWasLearnedAndWhatMovedFirst) {
  const auto press = Open();
  Store(0, Leaking());  // too few to learn from
  ASSERT_OK(press->CatchUp(900));
  EXPECT_THAT(DriftSection(press->axis(0), 100).value(), HasSubstr("being learned"));
  EXPECT_EQ(DriftVerdictBox(press->axis(0)), "");
  Store(1, Healthy());
  Store(1, Leaking());
  ASSERT_OK(press->CatchUp(1000));
  const std::string section = DriftSection(press->axis(1), 100).value();
  EXPECT_THAT(section, HasSubstr("Reference 1, learned from strokes 0 to 99"));
  EXPECT_LT(section.find("internal_leakage, deviation"), section.find("K′, deviation"));
  for (const char* curve : {"bulk modulus", "valve flow", "dead volume"})
    EXPECT_THAT(section, HasSubstr(curve));
  EXPECT_THAT(DriftVerdictBox(press->axis(1)), testing::ContainsRegex(kInternalLeakageAppeared));
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
  EXPECT_THAT(Events(), testing::ElementsAre(HasSubstr("reference_learned")));
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

TEST_F(PressMonitorTest, IdleSuppressesWhatIsNewAndLeavesWhatStands) {
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
  EXPECT_THAT(Standing(axis), Contains("DSUPR no_samples"));
  EXPECT_EQ(axis.Health(), 'M');
  ASSERT_OK(axis.SetSuppression(kSuppressedIdle, false, 1004));
  EXPECT_THAT(Standing(axis), Contains("UNACK no_samples"));
  EXPECT_EQ(axis.Health(), 'F');
  ASSERT_OK(axis.Observe("no_samples", {1, 1, 0, false}, std::nullopt, 1005));
  EXPECT_THAT(Standing(axis), Contains("RTNUN no_samples"));
}

ValveCheckRecord Check(double f0, const char* outcome = "measured") {
  ValveCheckRecord check;
  check.outcome = outcome;
  check.f0 = f0;
  check.f0_std = 0.2;
  check.damping = 0.67;
  check.damping_std = 0.002;
  check.dead_time = 1e-3;
  check.dead_time_std = 1e-5;
  check.oil_temperature = 313;
  return check;
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

/// Bytes with the format number that follows a magic number put back by one.
std::vector<std::uint8_t> OfOlderFormat(std::vector<std::uint8_t> bytes, std::uint32_t magic) {
  const auto* begin = reinterpret_cast<const std::uint8_t*>(&magic);
  const auto at = std::search(bytes.begin(), bytes.end(), begin, begin + sizeof magic);
  EXPECT_NE(at, bytes.end());
  if (at != bytes.end()) --*(at + sizeof magic);
  return bytes;
}
constexpr std::uint32_t kMonitorMagic = 0x4d524448, kReferenceMagic = 0x46455248;

/// A press that found a leak, whose saved state is then of an older format.
class OlderStateTest : public PressMonitorTest {
 protected:
  void SetUp() override {
    PressMonitorTest::SetUp();
    Store(0, Healthy());
    Store(0, Leaking());
    ASSERT_OK(Open()->CatchUp(1000));
    rows_ = Journal().size();
  }
  void MakeStateOlder() {
    auto journal = AlarmJournal::Open(AlarmJournal::PathFor(DatabasePath())).value();
    ASSERT_OK(journal.Change("press/left", 1001, [](AxisContent& axis) -> Status {
      axis.monitor.state = OfOlderFormat(axis.monitor.state, kMonitorMagic);
      return {};
    }));
  }
  void AddOlderReference() {
    auto journal = AlarmJournal::Open(AlarmJournal::PathFor(DatabasePath())).value();
    StoredReference reference = journal.LatestReference("press/left").value().value();
    ++reference.version;
    reference.bytes = OfOlderFormat(reference.bytes, kReferenceMagic);
    ASSERT_OK(journal.Change("press/left", 1002, [&](AxisContent& axis) -> Status {
      axis.references.push_back(reference);
      return {};
    }));
  }
  /// "EVENT ALARM" of the rows since SetUp().
  std::vector<std::string> NewEvents() const {
    std::vector<std::string> events;
    for (const JournalRow& row : Journal())
      if (row.sequence > static_cast<std::int64_t>(rows_))
        events.push_back(row.event.event + " " + row.event.alarm);
    return events;
  }
  std::string NewText(const std::string& event) const {
    for (const JournalRow& row : Journal())
      if (row.sequence > static_cast<std::int64_t>(rows_) && row.event.event == event) return row.event.text;
    return "";
  }
  std::size_t rows_ = 0;
};

TEST_F(OlderStateTest, TheMonitorGoesOnAgainstTheFrozenReferenceAndTellsNothingTwice) {
  MakeStateOlder();
  const auto press = Open();
  ASSERT_OK(press->CatchUp(2000));
  ASSERT_NE(press->axis(0).monitor(), nullptr);
  EXPECT_EQ(press->axis(0).monitor()->reference().version(), 1);
  EXPECT_THAT(Standing(press->axis(0)), testing::ElementsAre("UNACK internal_leakage"));
  ASSERT_EQ(press->axis(0).monitor()->findings().size(), 1u) << "the finding is known again";
  EXPECT_THAT(NewText("monitor_begun_anew"), HasSubstr("against reference 1"));
  Store(0, Leaking());
  ASSERT_OK(press->CatchUp(3000));
  EXPECT_THAT(NewEvents(), testing::Not(Contains(HasSubstr("raised"))));
  Store(0, Healthy());  // the seal is changed: the alarm that was raised before clears
  ASSERT_OK(press->CatchUp(4000));
  EXPECT_THAT(NewEvents(), Contains("cleared internal_leakage"));
  const std::size_t rows = Journal().size();
  ASSERT_OK(Open()->CatchUp(5000));
  EXPECT_EQ(Journal().size(), rows) << "the new state is read";
}

TEST_F(OlderStateTest, AReferenceThatCannotBeReadIsLearnedAnewFromItsStrokes) {
  MakeStateOlder();
  AddOlderReference();
  const auto press = Open();
  ASSERT_OK(press->CatchUp(2000));
  ASSERT_NE(press->axis(0).monitor(), nullptr);
  EXPECT_EQ(press->axis(0).monitor()->reference().version(), 3);
  EXPECT_EQ(press->axis(0).monitor()->reference().last_sequence(), 99) << "not from the leaking strokes";
  EXPECT_THAT(NewText("reference_learned"),
              HasSubstr("reference 2, which this version of the program cannot read"));
  EXPECT_THAT(NewText("monitor_begun_anew"), HasSubstr("against reference 3"));
  EXPECT_THAT(Standing(press->axis(0)), testing::ElementsAre("UNACK internal_leakage"));
  EXPECT_THAT(NewEvents(), testing::Not(Contains(HasSubstr("raised"))));
}

TEST_F(OlderStateTest, WithoutStrokesToLearnFromCommissioningBeginsAnew) {
  auto journal = AlarmJournal::Open(AlarmJournal::PathFor(DatabasePath())).value();
  MakeStateOlder();
  AddOlderReference();
  StoredReference lost = journal.LatestReference("press/left").value().value();
  ++lost.version;
  lost.first_stroke = lost.last_stroke = 1'000'000;  // as of a database that was begun anew
  ASSERT_OK(journal.Change("press/left", 1003, [&](AxisContent& axis) -> Status {
    axis.references.push_back(lost);
    return {};
  }));
  const auto press = Open();
  ASSERT_OK(press->CatchUp(2000));
  EXPECT_EQ(press->axis(0).monitor(), nullptr);
  EXPECT_EQ(press->axis(0).Health(), 'C');
  EXPECT_THAT(NewText("monitor_begun_anew"), HasSubstr("learned anew from stroke"));
  Store(0, Healthy());
  ASSERT_OK(press->CatchUp(3000));
  ASSERT_NE(press->axis(0).monitor(), nullptr);
  EXPECT_EQ(press->axis(0).monitor()->reference().version(), 4);
}

TEST_F(OlderStateTest, AStateFromBeforeTheHistoryWasKeptIsStillRead) {
  auto journal = AlarmJournal::Open(AlarmJournal::PathFor(DatabasePath())).value();
  ASSERT_OK(journal.Change("press/left", 1001, [](AxisContent& axis) -> Status {
    ByteWriter history;
    FindingHistory one;
    drift::DriftFinding finding;
    finding.state = drift::FindingState::kNamed;
    finding.rule = "internal_leakage";
    finding.parts.push_back({"internal_leakage", "m3/(s Pa)", 1, 1, 1, 1, false});
    one.Follow({finding}, 1, 1);
    one.Save(history);
    axis.monitor.state.resize(axis.monitor.state.size() - history.Take().size());
    return {};
  }));
  const auto press = Open();
  ASSERT_OK(press->CatchUp(2000));
  EXPECT_THAT(NewEvents(), IsEmpty());
  ASSERT_EQ(press->axis(0).monitor()->findings().size(), 1u);
}

TEST_F(OlderStateTest, DamagedBytesAreNoCrash) {
  auto journal = AlarmJournal::Open(AlarmJournal::PathFor(DatabasePath())).value();
  const std::vector<std::uint8_t> sound = journal.Axis("press/left").value().monitor.state;
  for (const std::size_t left : {std::size_t{1}, std::size_t{12}, sound.size() / 2, sound.size() - 1}) {
    ASSERT_OK(journal.Change("press/left", 1001, [&](AxisContent& axis) -> Status {
      axis.monitor.state.assign(sound.begin(), sound.begin() + static_cast<long>(left));
      return {};
    }));
    const auto press = Open();
    ASSERT_OK(press->CatchUp(2000));
    EXPECT_THAT(Standing(press->axis(0)), testing::ElementsAre("UNACK internal_leakage")) << left << " bytes";
  }
}

}  // namespace
}  // namespace hydroscope
