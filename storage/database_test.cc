#include "storage/database.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using namespace storage_test;
using testing::ElementsAre;
using testing::HasSubstr;

bool Same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

TEST(Database, IsForItsOwnerAndGroupWithWhatLiesBesideIt) {
  const Folder folder;
  Press press(folder.File());
  for (const char* part : {"", "-wal", "-shm"}) {
    const auto others =
        std::filesystem::status(folder.File() + part).permissions() & std::filesystem::perms::others_all;
    EXPECT_EQ(others, std::filesystem::perms::none) << part;
  }
}

TEST(Database, DamageSomewhereInTheFileIsFound) {
  const Folder folder;
  {
    Press press(folder.File());
    EXPECT_OK(press.database.StoreStrokes(press.Begin("a.csv").id, MakeStrokes(0, 200)));
  }
  EXPECT_OK(Database::Check(folder.File(), {}));
  std::fstream file(folder.File(), std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(32 << 10);
  file << std::string(64 << 10, 'x') << std::flush;
  const Status checked = Database::Check(folder.File(), {});
  ASSERT_FALSE(checked);
  EXPECT_THAT(checked.error().text, HasSubstr("is damaged ("));
}

TEST(Database, APageThatCannotBeReadIsNoDamage) {
  const Folder folder;
  Press press(folder.File());
  EXPECT_OK(press.database.StoreStrokes(press.Begin("a.csv").id, MakeStrokes(0, 200)));
  std::filesystem::remove(folder.File() + "-wal");  // pages that stand in it are missing for who comes now
  const Status checked = Database::Check(folder.File(), {});
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().kind, ErrorKind::kInternal) << checked.error().text;
}

TEST(Database, GivesBackWhatWasStoredToTheBit) {
  const Folder folder;
  Press press(folder.File());
  const RunInfo run = press.Begin("a.csv");
  const auto offered = MakeStrokes(0, 20);
  EXPECT_OK(press.database.StoreStrokes(run.id, offered));

  const auto strokes = Value(press.database.Strokes(run.id));
  ASSERT_EQ(strokes.size(), offered.size());
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    const StrokeSummary &got = strokes[i], &expected = offered[i].summary;
    EXPECT_EQ(got.index, expected.index);
    EXPECT_EQ(got.begin, expected.begin);
    EXPECT_EQ(got.end, expected.end);
    EXPECT_TRUE(Same(got.oil_temperature, expected.oil_temperature)) << i;
    EXPECT_EQ(got.conditions, expected.conditions);
    EXPECT_EQ(got.rms_error, expected.rms_error);
    EXPECT_EQ(got.noise_floor, expected.noise_floor);
    EXPECT_EQ(got.counters.samples, expected.counters.samples);
    EXPECT_EQ(got.counters.gated, expected.counters.gated);
    EXPECT_EQ(got.counters.used, expected.counters.used);
    EXPECT_EQ(got.counters.flagged, expected.counters.flagged);
  }
  const auto grams = Value(press.database.Grams(press.machine, 0, 100));
  ASSERT_EQ(grams.size(), offered.size());
  for (std::size_t i = 0; i < grams.size(); ++i) {
    EXPECT_EQ(grams[i].blocks, offered[i].gram.blocks);
    EXPECT_EQ(grams[i].integral, offered[i].gram.integral);
    EXPECT_EQ(grams[i].flow, offered[i].gram.flow);
  }
}

TEST(Database, KeepsTheTrendOfOneParameterInOrderWithNaNAndReason) {
  const Folder folder;
  Press press(folder.File());
  const auto first = press.Begin("a.csv");
  EXPECT_OK(press.database.StoreStrokes(first.id, MakeStrokes(0, 6)));
  EXPECT_OK(press.database.FinishRun(first.id, "{}", {}));
  const auto second = press.Begin("b.csv");
  EXPECT_OK(press.database.StoreStrokes(second.id, MakeStrokes(0, 6, 6, 2)));

  const auto trend = Value(press.database.Trend(press.machine, "Q_vn"));
  ASSERT_EQ(trend.size(), 12u);
  for (std::size_t i = 0; i < trend.size(); ++i) {
    const auto& expected = MakeStroke(i % 6, 6, i < 6 ? 1 : 2);
    EXPECT_EQ(trend[i].sequence, static_cast<std::int64_t>(i));
    EXPECT_EQ(trend[i].run, i < 6 ? first.id : second.id);
    EXPECT_EQ(trend[i].stroke, static_cast<std::int64_t>(i % 6));
    EXPECT_EQ(trend[i].time, expected.summary.end);
    EXPECT_TRUE(Same(trend[i].oil_temperature, expected.summary.oil_temperature));
    EXPECT_EQ(trend[i].estimate.parameter, "Q_vn");
    EXPECT_EQ(trend[i].estimate.unit, "m3/s");
    EXPECT_EQ(trend[i].estimate.value, expected.estimates[2].value);
    EXPECT_TRUE(Same(trend[i].estimate.std, expected.estimates[2].std));
    EXPECT_EQ(trend[i].estimate.reason, EstimateReason::kConfounded);
    EXPECT_EQ(trend[i].estimate.oil_temperature, expected.estimates[2].oil_temperature);
  }
  const auto all = Value(press.database.Trend(press.machine, ""));
  ASSERT_EQ(all.size(), 48u);
  EXPECT_EQ(all[0].estimate.parameter, "K");
  EXPECT_EQ(all[3].estimate.parameter, "y_0");
  EXPECT_TRUE(std::isnan(all[3].estimate.last_excited));
  EXPECT_TRUE(std::isnan(all[3].estimate.oil_temperature));
  EXPECT_EQ(all[4].sequence, 1);
  EXPECT_TRUE(Value(press.database.Trend(press.machine, "no_such")).empty());
}

TEST(Database, TheTrendCanStartAnywhere) {
  const Folder folder;
  Press press(folder.File());
  for (const char* log : {"a.csv", "b.csv", "c.csv"}) {
    const auto run = press.Begin(log);
    EXPECT_OK(press.database.StoreStrokes(run.id, MakeStrokes(0, log[0] == 'b' ? 0 : 5)));
    EXPECT_OK(press.database.FinishRun(run.id, "", {}));
  }
  for (const std::int64_t first : {-3, 0, 1, 4, 5, 9, 10, 11}) {
    const auto trend = Value(press.database.Trend(press.machine, "V0", first));
    const std::int64_t expected = std::clamp<std::int64_t>(first, 0, 10);
    ASSERT_EQ(trend.size(), static_cast<std::size_t>(10 - expected)) << first;
    for (std::size_t i = 0; i < trend.size(); ++i)
      EXPECT_EQ(trend[i].sequence, expected + static_cast<int>(i));
    EXPECT_EQ(Value(press.database.Trend(press.machine, "", first)).size(), 4 * trend.size());
  }
}

TEST(Database, TheTrendReadInPiecesIsTheTrend) {
  const Folder folder;
  Press press(folder.File());
  for (const char* log : {"a.csv", "b.csv", "c.csv"}) {
    const auto run = press.Begin(log);
    EXPECT_OK(press.database.StoreStrokes(run.id, MakeStrokes(0, log[0] == 'b' ? 0 : 5)));
    EXPECT_OK(press.database.FinishRun(run.id, "", {}));
  }
  for (const std::int64_t piece : {1, 3, 4, 10, 99}) {
    std::vector<std::int64_t> sequences;
    for (std::int64_t first = 0; first < 10; first += piece)
      for (const TrendPoint& point : Value(press.database.Trend(press.machine, "V0", first, first + piece)))
        sequences.push_back(point.sequence);
    EXPECT_THAT(sequences, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9)) << piece;
  }
  EXPECT_THAT(Value(press.database.ParameterNames(press.machine)), ElementsAre("K", "V0", "Q_vn", "y_0"));
}

TEST(Database, SameCallsIntoTwoFilesGiveTheSameDigest) {
  const Folder folder;
  std::vector<std::string> digests;
  for (const char* file : {"one.db", "two.db"}) {
    Press press(folder.File(file));
    const auto run = press.Begin("a.csv");
    EXPECT_OK(press.database.StoreStrokes(run.id, MakeStrokes(0, 130)));
    EXPECT_OK(press.database.FinishRun(run.id, "{\"rows\":5}", {1, 2, 3}));
    digests.push_back(Value(press.database.ContentDigest()));
  }
  EXPECT_EQ(digests[0], digests[1]);
}

TEST(Database, DigestDoesNotDependOnHowStrokesAreCutIntoBatches) {
  const Folder folder;
  std::vector<std::string> digests;
  for (const std::int64_t batch : {1, 7, 130}) {
    Press press(folder.File(std::to_string(batch)));
    const auto run = press.Begin("a.csv");
    for (std::int64_t at = 0; at < 130; at += batch)
      EXPECT_OK(
          press.database.StoreStrokes(run.id, MakeStrokes(at, std::min<std::int64_t>(at + batch, 130))));
    digests.push_back(Value(press.database.ContentDigest()));
  }
  EXPECT_EQ(digests[0], digests[1]);
  EXPECT_EQ(digests[0], digests[2]);
}

TEST(Database, DigestChangesWithTheLastBitOfOneValue) {
  const Folder folder;
  std::vector<std::string> digests;
  for (const double factor : {1.0, 1.0 + 0x1p-52}) {
    Press press(folder.File(std::to_string(digests.size())));
    const auto run = press.Begin("a.csv");
    auto strokes = MakeStrokes(0, 3);
    strokes[1].estimates[0].value *= factor;
    EXPECT_OK(press.database.StoreStrokes(run.id, strokes));
    digests.push_back(Value(press.database.ContentDigest()));
  }
  EXPECT_NE(digests[0], digests[1]);
}

TEST(Database, StrokesAlreadyStoredAreSkipped) {
  const Folder folder;
  Press press(folder.File());
  const auto run = press.Begin("a.csv");
  EXPECT_OK(press.database.StoreStrokes(run.id, MakeStrokes(0, 10)));
  const std::string digest = Value(press.database.ContentDigest());
  EXPECT_OK(press.database.StoreStrokes(run.id, MakeStrokes(0, 10)));
  EXPECT_EQ(Value(press.database.ContentDigest()), digest);
  EXPECT_OK(press.database.StoreStrokes(run.id, MakeStrokes(4, 15)));
  EXPECT_EQ(Value(press.database.Strokes(run.id)).size(), 15u);
}

TEST(Database, AStoredStrokeOfferedWithOtherContentIsAnErrorAndNothingIsStored) {
  const Folder folder;
  Press press(folder.File());
  const auto run = press.Begin("a.csv");
  EXPECT_OK(press.database.StoreStrokes(run.id, MakeStrokes(0, 3)));
  auto offered = MakeStrokes(2, 6);
  offered[0].gram.flow(1, 2) += 1e-20;
  const Status stored = press.database.StoreStrokes(run.id, offered);
  ASSERT_FALSE(stored.has_value());
  EXPECT_EQ(stored.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(stored.error().text, HasSubstr("a.csv), stroke 2: it is stored with other content"));
  EXPECT_EQ(Value(press.database.Strokes(run.id)).size(), 3u);
}

TEST(Database, AHoleInTheStrokesIsAnErrorAndNothingIsStored) {
  const Folder folder;
  Press press(folder.File());
  const auto run = press.Begin("a.csv");
  auto strokes = MakeStrokes(0, 6);
  strokes.erase(strokes.begin() + 3);
  const Status stored = press.database.StoreStrokes(run.id, strokes);
  ASSERT_FALSE(stored.has_value());
  EXPECT_THAT(stored.error().text, HasSubstr("would leave a hole"));
  EXPECT_TRUE(Value(press.database.Strokes(run.id)).empty());
}

TEST(Database, AGramThatDoesNotFitTheModelIsRefused) {
  const Folder folder;
  Press press(folder.File(), 6);
  const auto run = press.Begin("a.csv");
  const Status stored = press.database.StoreStrokes(run.id, MakeStrokes(0, 1, 7));
  ASSERT_FALSE(stored.has_value());
  EXPECT_THAT(stored.error().text, HasSubstr("dimension 7"));
  EXPECT_THAT(stored.error().text, HasSubstr("6 columns"));
}

TEST(Database, AModelThatChangesBecomesANewVersion) {
  const Folder folder;
  Press press(folder.File());
  EXPECT_EQ(press.version, 1);
  EXPECT_EQ(Value(press.database.PutModelVersion(press.machine, {0, "name = \"press 7\"", ColumnNames(6)})),
            1);
  EXPECT_EQ(Value(press.database.PutModelVersion(press.machine, {0, "name = \"other\"", ColumnNames(6)})), 2);
  EXPECT_EQ(Value(press.database.PutModelVersion(press.machine, {0, "name = \"other\"", ColumnNames(7)})), 3);
  const ModelVersion first = Value(press.database.GetModelVersion(press.machine, 1));
  EXPECT_EQ(first.definition, "name = \"press 7\"");
  EXPECT_EQ(first.columns, ColumnNames(6));
  EXPECT_EQ(Value(press.database.GetModelVersion(press.machine, 3)).columns, ColumnNames(7));
  const auto missing = press.database.GetModelVersion(press.machine, 4);
  ASSERT_FALSE(missing.has_value());
  EXPECT_THAT(missing.error().text, HasSubstr("versions 1 to 3"));
}

TEST(Database, TwoMachinesAreKeptApart) {
  const Folder folder;
  Press press(folder.File());
  const std::int64_t other = Value(press.database.MachineId("press 8"));
  ASSERT_NE(other, press.machine);
  EXPECT_EQ(Value(press.database.MachineId("press 8")), other);
  const int version = Value(press.database.PutModelVersion(other, {0, "", ColumnNames(3)}));
  const auto run = press.Begin("a.csv");
  const auto run_other = Value(press.database.BeginRun(other, version, "a.csv", "fingerprint of a.csv"));
  EXPECT_NE(run.id, run_other.id);
  EXPECT_OK(press.database.StoreStrokes(run.id, MakeStrokes(0, 4)));
  EXPECT_OK(press.database.StoreStrokes(run_other.id, MakeStrokes(0, 2, 3)));
  EXPECT_EQ(Value(press.database.Trend(press.machine, "K")).size(), 4u);
  EXPECT_EQ(Value(press.database.Trend(other, "K")).size(), 2u);
  EXPECT_EQ(Value(press.database.Grams(other, 0, 10)).size(), 2u);
  EXPECT_THAT(Value(press.database.MachineNames()), ElementsAre("press 7", "press 8"));
}

TEST(Database, ReadersSeeTheLastCommittedStrokesWhileAnotherWrites) {
  const Folder folder;
  Press press(folder.File());
  const auto run = press.Begin("a.csv");
  EXPECT_OK(press.database.StoreStrokes(run.id, MakeStrokes(0, 5)));
  const Database reader = Value(Database::OpenReadOnly(folder.File()));
  EXPECT_EQ(Value(reader.Strokes(run.id)).size(), 5u);
  EXPECT_OK(press.database.StoreStrokes(run.id, MakeStrokes(5, 9)));
  EXPECT_EQ(Value(reader.Strokes(run.id)).size(), 9u);
}

TEST(Database, IntegrityCheckPassesOnAFileOfSeveralRuns) {
  const Folder folder;
  Press press(folder.File());
  for (const char* log : {"a.csv", "b.csv", "c.csv"}) {
    const auto run = press.Begin(log);
    EXPECT_OK(press.database.StoreStrokes(run.id, MakeStrokes(0, 70)));
    EXPECT_OK(press.database.FinishRun(run.id, "{}", {}));
  }
  EXPECT_OK(press.database.CheckIntegrity());
}

}  // namespace
}  // namespace hydroscope
