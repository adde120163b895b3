// What the journal keeps of an AxisMonitor, and how it goes on when that cannot be read.
#include "monitor/press_monitor_fixture.h"

namespace hydroscope {
namespace {

using namespace press_monitor_test;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

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
