#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/constants.h"
#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using namespace storage_test;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kPlenty = 1 << 30;

RawWindow MakeRaw(std::int64_t first, std::int64_t last) {
  RawWindow raw{{"p_A", "z"}, {}, {{}, {}}, {}};
  for (std::int64_t row = first; row < last; ++row) {
    raw.time.push_back(0.001 * row);
    raw.values[0].push_back(1e7 + 1e5 * Noise(row));
    raw.values[1].push_back(row % 100 == 7 ? std::nan("") : 0.1 + 1e-4 * row);
  }
  return raw;
}

Status Store(Database& database, std::int64_t run, const RawWindow& raw, std::int64_t max_bytes) {
  return database.StoreRaw(run, raw.signals, raw.time, raw.values, max_bytes);
}

void ExpectSame(const RawWindow& got, const RawWindow& expected) {
  EXPECT_EQ(got.signals, expected.signals);
  ASSERT_EQ(got.time, expected.time);
  for (std::size_t i = 0; i < expected.values.size(); ++i)
    for (std::size_t row = 0; row < expected.time.size(); ++row) {
      const double a = got.values[i][row], b = expected.values[i][row];
      ASSERT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << i << ", " << row;
    }
}

TEST(RawWindow, SamplesComeBackToTheBitNaNIncluded) {
  const Folder folder;
  Press press(folder.File());
  const auto run = press.Begin("a.csv");
  EXPECT_OK(Store(press.database, run.id, MakeRaw(0, 2500), kPlenty));
  EXPECT_OK(Store(press.database, run.id, MakeRaw(2500, 2600), kPlenty));
  ExpectSame(Value(press.database.LoadRaw(run.id, 0, 1e9)), MakeRaw(0, 2600));
}

TEST(RawWindow, WhereRowsAreKeptAgainIsFoundAcrossTimesWithoutAny) {
  const Folder folder;
  Press press(folder.File());
  const auto run = press.Begin("a.csv");
  constexpr std::int64_t kLater = 1'000'000'000;  // rows of 1 ms
  EXPECT_OK(Store(press.database, run.id, MakeRaw(1000, 4000), kPlenty));
  EXPECT_OK(Store(press.database, run.id, MakeRaw(kLater, kLater + 10), kPlenty));
  const auto next = [&](double from) { return Value(press.database.NextRaw(run.id, from)); };
  EXPECT_EQ(next(0), 0.001 * 1000);
  EXPECT_EQ(next(2.5), 2.5) << "in the midst of rows";
  EXPECT_EQ(next(4), 0.001 * kLater);
  EXPECT_EQ(next(0.001 * kLater), 0.001 * kLater);
  EXPECT_EQ(next(0.001 * kLater + 1), kInfinity);
  EXPECT_EQ(Value(press.database.NextRaw(run.id + 1, 0)), kInfinity);
  EXPECT_EQ(Value(press.database.LoadRaw(run.id, 3.9, 2e6)).time.size(), 110u) << "100 before, 10 after";
}

TEST(RawWindow, APieceOfTimeIsCutExactly) {
  const Folder folder;
  Press press(folder.File());
  const auto run = press.Begin("a.csv");
  EXPECT_OK(Store(press.database, run.id, MakeRaw(0, 5000), kPlenty));
  const RawWindow raw = MakeRaw(0, 5000);
  ExpectSame(Value(press.database.LoadRaw(run.id, raw.time[999], raw.time[2001])), MakeRaw(999, 2001));
  EXPECT_TRUE(Value(press.database.LoadRaw(run.id, 100, 200)).time.empty());
  EXPECT_TRUE(Value(press.database.LoadRaw(run.id, 3, 3)).time.empty());
}

TEST(RawWindow, TheOldestSamplesGoWhenTheWindowIsFull) {
  const Folder folder;
  Press press(folder.File());
  const auto run = press.Begin("a.csv");
  EXPECT_OK(Store(press.database, run.id, MakeRaw(0, 1000), kPlenty));
  SQLite::Database db(folder.File());
  const std::int64_t room = 6 * db.execAndGet("SELECT length(samples) FROM raw_chunk").getInt64();
  for (std::int64_t at = 1000; at < 20'000; at += 1000)
    EXPECT_OK(Store(press.database, run.id, MakeRaw(at, at + 1000), room));
  const RawWindow kept = Value(press.database.LoadRaw(run.id, 0, 1e9));
  const auto rows = static_cast<std::int64_t>(kept.time.size());
  ExpectSame(kept, MakeRaw(20'000 - rows, 20'000));
  EXPECT_GE(rows, 5000);
  EXPECT_LT(rows, 10'000);
  const std::int64_t bytes = db.execAndGet("SELECT sum(length(samples)) FROM raw_chunk").getInt64();
  EXPECT_LE(bytes, room);
  EXPECT_EQ(bytes, db.execAndGet("SELECT raw_bytes FROM machine").getInt64());
}

TEST(RawWindow, AResumedReplayOffersTheSameRowsAgainAndNothingChanges) {
  const Folder folder;
  Press press(folder.File());
  const auto run = press.Begin("a.csv");
  const std::int64_t room = 40'000;
  for (std::int64_t at = 0; at < 8000; at += 1000)
    EXPECT_OK(Store(press.database, run.id, MakeRaw(at, at + 1000), room));
  const std::string digest = Value(press.database.ContentDigest());
  for (std::int64_t at = 0; at < 8000; at += 1000)
    EXPECT_OK(Store(press.database, run.id, MakeRaw(at, at + 1000), room));
  EXPECT_EQ(Value(press.database.ContentDigest()), digest);
}

TEST(RawWindow, NoRoomMeansNothingIsKept) {
  const Folder folder;
  Press press(folder.File());
  const auto run = press.Begin("a.csv");
  EXPECT_OK(Store(press.database, run.id, MakeRaw(0, 1000), 0));
  EXPECT_TRUE(Value(press.database.LoadRaw(run.id, 0, 1e9)).time.empty());
}

TEST(RawWindow, WrongShapesAndTimesAreNamed) {
  const Folder folder;
  Press press(folder.File());
  auto& db = press.database;
  const auto run = press.Begin("a.csv").id;
  EXPECT_THAT(db.StoreRaw(run, {"p"}, {1, 2}, {{3}}, kPlenty).error().text,
              HasSubstr("p has 1 rows, time has 2"));
  EXPECT_THAT(db.StoreRaw(run, {"p", "q"}, {1}, {{3}}, kPlenty).error().text,
              HasSubstr("2 signal names for 1 columns"));
  EXPECT_THAT(db.StoreRaw(run, {"p,q"}, {1}, {{3}}, kPlenty).error().text, HasSubstr("\"p,q\""));
  EXPECT_THAT(db.StoreRaw(run, {"p"}, {1, 1}, {{3, 4}}, kPlenty).error().text,
              HasSubstr("does not increase at row 1"));
  EXPECT_THAT(db.StoreRaw(run, {"p"}, {std::nan("")}, {{3}}, kPlenty).error().text, HasSubstr("row 0"));
  EXPECT_TRUE(Value(db.LoadRaw(run, -1e9, 1e9)).time.empty());
}

TEST(RawWindow, ADamagedChunkIsAnErrorThatNamesItsTime) {
  const Folder folder;
  Press press(folder.File());
  const auto run = press.Begin("a.csv");
  EXPECT_OK(Store(press.database, run.id, MakeRaw(1000, 1500), kPlenty));
  {
    SQLite::Database db(folder.File(), SQLite::OPEN_READWRITE);
    db.exec("UPDATE raw_chunk SET samples = x'0102'");
  }
  EXPECT_THAT(press.database.LoadRaw(run.id, 0, 10).error().text, HasSubstr("raw samples from 1 s: damaged"));
}

}  // namespace
}  // namespace hydroscope
