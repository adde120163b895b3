#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/gram_rollup.h"
#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using namespace storage_test;
using testing::HasSubstr;

StrokeGram DirectSum(const std::vector<StrokeGram>& grams) {
  StrokeGram sum;
  for (const StrokeGram& gram : grams) EXPECT_TRUE(AddGram(sum, gram));
  return sum;
}

/// Equal up to 1e-12 of the size of the summands (an element may cancel to nearly nothing).
void ExpectEqual(const SymmetricMatrix& a, const SymmetricMatrix& b, double size) {
  ASSERT_EQ(a.dimension(), b.dimension());
  for (std::size_t k = 0; k < a.packed().size(); ++k)
    EXPECT_NEAR(a.packed()[k], b.packed()[k], 1e-12 * size) << k;
}

void ExpectEqual(const StrokeGram& a, const StrokeGram& b) {
  EXPECT_EQ(a.blocks, b.blocks);
  EXPECT_EQ(a.spans, b.spans);
  EXPECT_EQ(a.windows, b.windows);
  const double strokes = static_cast<double>(a.spans) / 3;
  ExpectEqual(a.integral, b.integral, 1e-6 * strokes);
  ExpectEqual(a.noise, b.noise, 1e-12 * strokes);
  ExpectEqual(a.flow, b.flow, 1e-8 * strokes);
}

std::int64_t StoredSums(const std::string& path, int strokes) {
  SQLite::Database db(path);
  return db.execAndGet("SELECT count(*) FROM gram_rollup WHERE strokes = " + std::to_string(strokes))
      .getInt64();
}

TEST(GramSum, EqualsTheDirectSumForEveryKindOfRange) {
  const Folder folder;
  Press press(folder.File());
  EXPECT_OK(press.database.StoreStrokes(press.Begin("a.csv").id, MakeStrokes(0, 8300)));
  EXPECT_EQ(StoredSums(folder.File(), 64), 129);
  EXPECT_EQ(StoredSums(folder.File(), 4096), 2);
  const std::pair<std::int64_t, std::int64_t> ranges[] = {
      {0, 8300},    {0, 64},    {1, 64},      {63, 65}, {64, 128},  {5, 5},       {0, 4096},
      {4096, 8192}, {17, 8211}, {8290, 9000}, {-5, 70}, {100, 101}, {9000, 9999}, {4000, 4200}};
  for (const auto& [first, last] : ranges) {
    SCOPED_TRACE(testing::Message() << first << " ... " << last);
    ExpectEqual(Value(press.database.SumGrams(press.machine, first, last)),
                DirectSum(Value(press.database.Grams(press.machine, first, last))));
  }
}

TEST(GramSum, TheStoredSumsAreTheSameToTheLastBitHoweverTheStrokesCame) {
  const Folder folder;
  const auto digest = [&](const std::string& file, const std::vector<int>& ends, bool reopened,
                          bool fetched = false) {
    Press press(folder.File(file));
    const auto run = press.Begin("a.csv").id;
    int from = 0;
    for (const int to : ends) {
      if (reopened) press.database = Value(Database::Open(folder.File(file)));
      // A refused batch leaves the group under way as it was.
      EXPECT_FALSE(press.database.StoreStrokes(run, MakeStrokes(to + 1, to + 2)).has_value());
      if (fetched) EXPECT_OK(press.database.FetchPages(run));
      EXPECT_OK(press.database.StoreStrokes(run, MakeStrokes(from, to)));
      from = to;
    }
    EXPECT_EQ(StoredSums(folder.File(file), 64), 2);
    return Value(press.database.ContentDigest());
  };
  const auto whole = digest("whole.db", {150}, false);
  EXPECT_EQ(digest("pieces.db", {10, 63, 64, 100, 128, 150}, false), whole);
  EXPECT_EQ(digest("lives.db", {10, 63, 64, 100, 128, 150}, true), whole);
  EXPECT_EQ(digest("fetched.db", {10, 63, 64, 100, 128, 150}, true, true), whole);
}

TEST(GramSum, TheSumsAreReallyUsed) {
  const Folder folder;
  Press press(folder.File());
  EXPECT_OK(press.database.StoreStrokes(press.Begin("a.csv").id, MakeStrokes(0, 70)));
  {
    SQLite::Database db(folder.File(), SQLite::OPEN_READWRITE);
    db.exec("DELETE FROM gram WHERE stroke < 64");
  }
  EXPECT_EQ(Value(press.database.SumGrams(press.machine, 0, 70)).spans, 3 * 70);
  EXPECT_THAT(press.database.SumGrams(press.machine, 0, 63).error().text, HasSubstr("Gram is missing"));
}

/// What a stroke would have to read if its group were not in memory.
void Forget(const std::string& path, const char* rows) {
  SQLite::Database(path, SQLite::OPEN_READWRITE).exec(std::string("DELETE FROM ") + rows);
}

TEST(GramSum, TheStrokeThatCompletesAGroupOfGroupsReadsNone) {
  const Folder folder;
  Press press(folder.File());
  const auto run = press.Begin("a.csv").id;
  EXPECT_OK(press.database.StoreStrokes(run, MakeStrokes(0, 4090)));
  Forget(folder.File(), "gram_rollup");
  EXPECT_OK(press.database.StoreStrokes(run, MakeStrokes(4090, 4100)));
  ExpectEqual(Value(press.database.SumGrams(press.machine, 0, 4096)),
              DirectSum(Value(press.database.Grams(press.machine, 0, 4096))));
  EXPECT_EQ(StoredSums(folder.File(), 4096), 1);
}

TEST(GramSum, GroupsThatAnEarlierProcessBeganAreReadInAPause) {
  const Folder folder;
  Press press(folder.File());
  const auto run = press.Begin("a.csv").id;
  EXPECT_OK(press.database.StoreStrokes(run, MakeStrokes(0, 4090)));
  press.database = Value(Database::Open(folder.File()));
  EXPECT_OK(press.database.FetchPages(run));
  Forget(folder.File(), "gram WHERE stroke >= 4032");
  Forget(folder.File(), "gram_rollup");
  EXPECT_OK(press.database.StoreStrokes(run, MakeStrokes(4090, 4100)));
  EXPECT_EQ(StoredSums(folder.File(), 64), 1);
  EXPECT_EQ(StoredSums(folder.File(), 4096), 1);
}

TEST(GramSum, GroupsReachAcrossRuns) {
  const Folder folder;
  Press press(folder.File());
  for (const char* log : {"a.csv", "b.csv", "c.csv"}) {
    const auto run = press.Begin(log);
    EXPECT_OK(press.database.StoreStrokes(run.id, MakeStrokes(0, 50)));
    EXPECT_OK(press.database.FinishRun(run.id, "", {}));
  }
  EXPECT_EQ(StoredSums(folder.File(), 64), 2);
  ExpectEqual(Value(press.database.SumGrams(press.machine, 0, 150)),
              DirectSum(Value(press.database.Grams(press.machine, 0, 150))));
}

TEST(GramSum, OtherLimitsInTheMachineFileStillAdd) {
  const Folder folder;
  Press press(folder.File());
  EXPECT_OK(press.database.StoreStrokes(press.Begin("a.csv").id, MakeStrokes(0, 40)));
  press.version = Value(press.database.PutModelVersion(press.machine, {0, "other limits", ColumnNames(6)}));
  EXPECT_OK(press.database.StoreStrokes(press.Begin("b.csv").id, MakeStrokes(0, 100)));
  EXPECT_EQ(StoredSums(folder.File(), 64), 1) << "strokes 0 to 63 are of two model versions";
  ExpectEqual(Value(press.database.SumGrams(press.machine, 0, 140)),
              DirectSum(Value(press.database.Grams(press.machine, 0, 140))));
}

TEST(GramSum, StrokesOfOtherColumnsDoNotAdd) {
  const Folder folder;
  Press press(folder.File());
  EXPECT_OK(press.database.StoreStrokes(press.Begin("a.csv").id, MakeStrokes(0, 40)));
  auto renamed = ColumnNames(6);
  renamed[2] = "accumulator";
  press.version = Value(press.database.PutModelVersion(press.machine, {0, "with accumulator", renamed}));
  EXPECT_OK(press.database.StoreStrokes(press.Begin("b.csv").id, MakeStrokes(0, 100)));
  const auto mixed = press.database.SumGrams(press.machine, 0, 140);
  ASSERT_FALSE(mixed.has_value());
  EXPECT_THAT(mixed.error().text, HasSubstr("stroke 40 was identified with model version 2"));
  EXPECT_OK(press.database.SumGrams(press.machine, 0, 40));
  EXPECT_OK(press.database.SumGrams(press.machine, 40, 140));
}

TEST(GramSum, WithoutStrokesTheSumIsEmpty) {
  const Folder folder;
  Press press(folder.File());
  EXPECT_EQ(Value(press.database.SumGrams(press.machine, 0, 100)).integral.dimension(), 0);
}

}  // namespace
}  // namespace hydroscope
