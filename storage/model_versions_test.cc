#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using namespace storage_test;
using testing::HasSubstr;

TEST(ModelVersions, ThePromotedLastIsInForceAndOldOnesStay) {
  const Folder folder;
  Press press(folder.File());
  Database& db = press.database;
  EXPECT_EQ(Value(db.PutModelVersion(press.machine, {0, "with a leak", ColumnNames(6)})), 2);
  EXPECT_FALSE(Value(db.PromotedModel(press.machine)).has_value());
  EXPECT_OK(db.PromoteModel(press.machine, 2));
  EXPECT_EQ(Value(db.PromotedModel(press.machine))->definition, "with a leak");
  EXPECT_OK(db.PromoteModel(press.machine, 1));
  EXPECT_EQ(Value(db.PromotedModel(press.machine))->version, 1);
  const auto versions = Value(db.ModelVersions(press.machine));
  ASSERT_EQ(versions.size(), 2u);
  EXPECT_EQ(versions[0].promoted, 2);
  EXPECT_EQ(versions[1].promoted, 1);
  EXPECT_EQ(versions[1].definition, "with a leak");
}

TEST(ModelVersions, AVersionThatIsNotStoredCannotBePromoted) {
  const Folder folder;
  Press press(folder.File());
  EXPECT_THAT(press.database.PromoteModel(press.machine, 7).error().text, HasSubstr("no model version 7"));
}

TEST(StrokeRange, TimeIsThatOfTheLogsIfTheyFollowOneAnother) {
  const Folder folder;
  Press press(folder.File());
  EXPECT_OK(press.database.StoreStrokes(press.Begin("a.csv").id, MakeStrokes(0, 10)));
  EXPECT_EQ(Value(press.database.SequenceAt(press.machine, -1)), 0);
  EXPECT_EQ(Value(press.database.SequenceAt(press.machine, 6.5)), 3);
  EXPECT_EQ(Value(press.database.SequenceAt(press.machine, 1e9)), 10);
  EXPECT_OK(press.database.StoreStrokes(press.Begin("b.csv").id, MakeStrokes(0, 10)));
  const auto ambiguous = press.database.SequenceAt(press.machine, 6.5);
  ASSERT_FALSE(ambiguous.has_value());
  EXPECT_THAT(ambiguous.error().text, HasSubstr("run:2"));
}

TEST(StrokeRange, OfManyStrokesEvenlySpreadSummariesAreRead) {
  const Folder folder;
  Press press(folder.File());
  EXPECT_OK(press.database.StoreStrokes(press.Begin("a.csv").id, MakeStrokes(0, 10)));
  EXPECT_OK(press.database.StoreStrokes(press.Begin("b.csv").id, MakeStrokes(0, 10)));
  const auto all = Value(press.database.SummariesOf(press.machine, 0, 100, 100));
  ASSERT_EQ(all.size(), 20u);
  EXPECT_EQ(all[13].index, 13);
  EXPECT_EQ(all[13].counters.used, 1080);
  EXPECT_EQ(all[13].begin, all[3].begin);
  const auto some = Value(press.database.SummariesOf(press.machine, 3, 18, 5));
  ASSERT_EQ(some.size(), 5u);
  EXPECT_EQ(some.front().index, 3);
  EXPECT_EQ(some.back().index, 15);
}

}  // namespace
}  // namespace hydroscope
