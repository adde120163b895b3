#include "storage/journal_pairing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/outbox.h"
#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using namespace storage_test;
using testing::HasSubstr;

constexpr double kWall = 1'763'806'500;  // 2025-11-22 10:15:00 UTC

class JournalPairing : public testing::Test {
 protected:
  std::optional<SetAsideJournal> Pair() {
    Database database = Value(Database::Open(folder_.File()));
    return Value(PairJournal(database, folder_.File(), "press", kWall));
  }
  AlarmJournal Journal() { return Value(AlarmJournal::Open(AlarmJournal::PathFor(folder_.File()))); }
  /// An alarm that stands, after `strokes` judged strokes.
  void Raise(std::int64_t strokes) {
    EXPECT_OK(Journal().Change("press 7", kWall, [&](AxisContent& axis) -> Status {
      AlarmState& alarm = axis.Alarm("internal_leakage");
      alarm.active = true;
      alarm.acknowledged = false;
      alarm.cause = {CauseKind::kNotProven, {"internal_leakage", "external_leakage"}};
      axis.monitor = {strokes, 1, {1}};
      AlarmEvent event;
      event.event = "raised";
      event.cause = CauseText(alarm.cause);
      axis.events.push_back(event);
      return {};
    }));
  }
  void Delete() {
    for (const char* end : {"", "-wal", "-shm"}) std::filesystem::remove(folder_.File() + end);
  }
  Folder folder_;
};

TEST_F(JournalPairing, AJournalOfADeletedDatabaseIsSetAsideWithNothingLost) {
  Pair();
  Raise(0);
  Delete();
  const auto aside = Pair();
  ASSERT_TRUE(aside.has_value());
  EXPECT_THAT(aside->path, HasSubstr("press.alarms.20251122T101500Z.db"));
  EXPECT_EQ(aside->rows, 1);
  EXPECT_EQ(aside->standing, 1);
  EXPECT_EQ(Value(Value(AlarmJournal::OpenExisting(aside->path)).Rows("")).size(), 1u);
  const auto rows = Value(Journal().Rows("press"));
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].event.event, "journal_set_aside");
  EXPECT_THAT(rows[0].event.text, HasSubstr("1 row, 1 alarm stood"));
  EXPECT_TRUE(Value(Journal().Axis("press 7")).alarms.empty()) << "nothing is inherited";
  EXPECT_FALSE(Pair().has_value()) << "the new one is its own";
}

TEST_F(JournalPairing, TheOutboxThatCountsItsRowsGoesWithIt) {
  Pair();
  EXPECT_OK(Value(Outbox::Open(Outbox::PathFor(folder_.File()))).Put({{5, "topic", "payload"}}, 5));
  Delete();
  ASSERT_TRUE(Pair().has_value());
  EXPECT_FALSE(std::filesystem::exists(Outbox::PathFor(folder_.File())));
  EXPECT_TRUE(std::filesystem::exists(folder_.File("press.outbox.20251122T101500Z.db")));
}

TEST_F(JournalPairing, APairThatMovedOrWasCopiedStaysAPair) {
  Pair();
  Raise(0);
  std::filesystem::create_directory(folder_.File("elsewhere"));
  for (const char* name : {"press.db", "press.alarms.db"})
    std::filesystem::copy(folder_.File(name), folder_.File("elsewhere") + "/" + name);
  const std::string copy = folder_.File("elsewhere") + "/press.db";
  Database database = Value(Database::Open(copy));
  EXPECT_FALSE(Value(PairJournal(database, copy, "press", kWall)).has_value());
  EXPECT_FALSE(Pair().has_value());
}

TEST_F(JournalPairing, AJournalOfAnOlderVersionIsTakenOverUnlessItIsAheadOfTheDatabase) {
  {
    Press press(folder_.File());
    EXPECT_OK(press.database.StoreStrokes(press.Begin("a.csv").id, MakeStrokes(0, 3)));
  }
  Raise(3);
  EXPECT_FALSE(Pair().has_value());
  EXPECT_EQ(Value(Journal().Axis("press 7")).alarms[0].cause,
            (AlarmCause{CauseKind::kNotProven, {"internal_leakage", "external_leakage"}}));
  Delete();
  for (const char* end : {"", "-wal", "-shm"})
    std::filesystem::remove(AlarmJournal::PathFor(folder_.File()) + end);
  Raise(3);  // no database was ever paired with it, and this one has no stroke
  EXPECT_TRUE(Pair().has_value());
}

}  // namespace
}  // namespace hydroscope
