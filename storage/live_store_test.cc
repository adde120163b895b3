#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using namespace storage_test;
using testing::HasSubstr;

const std::vector<std::string> kSignals = {"p_A", "z"};
constexpr int kColumns = 20;

LiveBatch Batch(std::int64_t first_row, std::int64_t last_row, std::int64_t first_stroke = 0,
                std::int64_t last_stroke = 0) {
  LiveBatch batch;
  batch.raw.Resize(2, static_cast<std::size_t>(last_row - first_row));
  for (std::int64_t row = first_row; row < last_row; ++row) {
    const auto k = static_cast<std::size_t>(row - first_row);
    batch.raw.time[k] = 0.001 * static_cast<double>(row);
    batch.raw.signal[0][k] = Noise(row);
    batch.raw.signal[1][k] = row % 50 == 0 ? std::nan("") : 1.0;
    batch.raw.quality[1][k] = row % 50 == 0 ? quality::kMissing : quality::kGood;
  }
  batch.strokes = MakeStrokes(first_stroke, last_stroke, kColumns);
  batch.pipeline_state = {1, 2, static_cast<std::uint8_t>(last_stroke)};
  batch.sender_marks = {7, static_cast<std::uint8_t>(last_row % 256)};
  batch.rows_taken = last_row;
  return batch;
}

Status Store(Press& press, std::int64_t run, LiveBatch batch, const RawLimits& limits = {}) {
  ColumnPacker packer;
  const PackedBatch packed = Pack(std::move(batch), packer);
  const LiveStep step{run, &packed};
  return press.database.StoreLive({&step, 1}, kSignals, limits);
}

TEST(LiveStore, RowsFlagsStrokesAndStateComeBack) {
  const Folder folder;
  Press press(folder.File(), kColumns);
  const auto run = press.Begin("live");
  EXPECT_OK(Store(press, run.id, Batch(0, 1500, 0, 3)));
  EXPECT_OK(Store(press, run.id, Batch(1500, 1600)));
  const RawWindow raw = Value(press.database.LoadRaw(run.id, 0, 1e9));
  ASSERT_EQ(raw.time.size(), 1600u);
  EXPECT_EQ(raw.flags[1][1550], quality::kMissing);
  EXPECT_EQ(raw.flags[1][1551], quality::kGood);
  EXPECT_EQ(raw.flags[0][1550], quality::kGood);
  EXPECT_EQ(raw.values[0][1234], Noise(1234));
  const auto newest = Value(press.database.NewestRun(1));
  ASSERT_TRUE(newest.has_value());
  EXPECT_EQ(newest->run.strokes, 3);
  EXPECT_EQ(newest->rows_taken, 1600);
  EXPECT_EQ(newest->sender_marks.back(), 1600 % 256);
}

/// Machines with a history whose newest strokes are stored together, as those of a press are.
struct Presses {
  static constexpr int kMachines = 100;  // whose pages are more than SQLite keeps by itself
  Presses(const std::string& path, std::int64_t history) : database(Value(Database::Open(path))) {
    for (int m = 0; m < kMachines; ++m) {
      const auto machine = Value(database.MachineId("axis " + std::to_string(m)));
      const auto version = Value(database.PutModelVersion(machine, {0, "", ColumnNames(1)}));
      if (history > 0) {
        const auto past = Value(database.BeginRun(machine, version, "past", "past"));
        EXPECT_OK(database.StoreStrokes(past.id, MakeStrokes(0, history, 1)));
        EXPECT_OK(database.FinishRun(past.id, "", {}));
      }
      runs.push_back(Value(database.BeginRun(machine, version, "live", "live")).id);
    }
    for (; next < 3; ++next) StoreNext();  // strokes of the run's own
  }
  void StoreNext() {
    std::vector<PackedBatch> batches;
    ColumnPacker packer;
    for (int m = 0; m < kMachines; ++m) {
      LiveBatch batch = Batch(next * 10, next * 10 + 10);
      batch.strokes = MakeStrokes(next, next + 1, 1);
      batches.push_back(Pack(std::move(batch), packer));
    }
    std::vector<LiveStep> steps;
    for (int m = 0; m < kMachines; ++m) steps.push_back({runs[m], &batches[m]});
    EXPECT_OK(database.StoreLive(steps, kSignals, {}));
  }
  /// Pages read from the file for the next stroke of each machine.
  std::int64_t PagesOfNext() {
    const std::int64_t before = database.PagesRead();
    StoreNext();
    ++next;
    return database.PagesRead() - before;
  }

  Database database;
  std::vector<std::int64_t> runs;
  std::int64_t next = 0;
};

TEST(LiveStore, StrokesReadHardlyAnyPagesHoweverLongTheHistory) {
  const Folder folder;
  Presses presses(folder.File(), 400);
  EXPECT_OK(presses.database.KeepPagesOf(Presses::kMachines));
  presses.PagesOfNext();
  EXPECT_LT(presses.PagesOfNext(), Presses::kMachines / 4) << "two of each without";
}

TEST(LiveStore, PagesFetchedInAPauseAreNotReadByStrokes) {
  const Folder folder;
  Presses presses(folder.File(), 400);
  EXPECT_OK(presses.database.KeepPagesOf(Presses::kMachines));
  const auto checkpoint = [&] { EXPECT_OK(Value(Database::Open(folder.File())).Checkpoint()); };
  checkpoint();  // by another connection, as the service does
  EXPECT_GT(presses.PagesOfNext(), 2 * Presses::kMachines) << "all is forgotten";
  checkpoint();
  for (const std::int64_t run : presses.runs) EXPECT_OK(presses.database.FetchPages(run));
  EXPECT_LT(presses.PagesOfNext(), Presses::kMachines) << "roots and what all machines share";
}

TEST(LiveStore, AStrokeIsWrittenToFewPagesHoweverLongTheHistory) {
  const Folder folder;
  Presses presses(folder.File(), 400);
  EXPECT_OK(presses.database.LeaveCheckpointsToPauses());
  const auto log_size = [&] { return std::filesystem::file_size(folder.File() + "-wal"); };
  presses.PagesOfNext();
  const auto before = log_size();
  presses.PagesOfNext();
  EXPECT_LT((log_size() - before) / 16384, 4 * Presses::kMachines)
      << "its own and that of its estimates; of the indexes of Grams and raw rows";
}

TEST(LiveStore, CheckpointsLeftToPausesHappenInThem) {
  const Folder folder;
  Press press(folder.File(), kColumns);
  EXPECT_OK(press.database.LeaveCheckpointsToPauses());
  const auto run = press.Begin("live");
  const auto log_size = [&] { return std::filesystem::file_size(folder.File() + "-wal"); };
  constexpr std::int64_t kRows = 250'000;
  std::int64_t row = 0;
  for (std::uintmax_t before = 0; before < (24u << 20); before = log_size(), row += kRows) {
    EXPECT_OK(Store(press, run.id, Batch(row, row + kRows)));
    ASSERT_GT(log_size(), before) << "a transaction had to wait for a checkpoint";
  }
  const auto longest = log_size(), stored = std::filesystem::file_size(folder.File());
  EXPECT_OK(press.database.Checkpoint());
  EXPECT_GT(std::filesystem::file_size(folder.File()), stored + (20u << 20));
  EXPECT_OK(Store(press, run.id, Batch(row, row + kRows)));
  EXPECT_EQ(log_size(), longest) << "the log does not begin anew behind a checkpoint";
  EXPECT_EQ(Value(press.database.NewestRun(1))->rows_taken, row + kRows);
}

TEST(LiveStore, ARefusedBatchLeavesNothingBehind) {
  const Folder folder;
  Press press(folder.File(), kColumns);
  const auto run = press.Begin("live");
  const Status refused = Store(press, run.id, Batch(0, 100, 5, 6));
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().text, HasSubstr("would leave a hole"));
  EXPECT_TRUE(Value(press.database.RawExtents(1)).empty());
  EXPECT_EQ(Value(press.database.NewestRun(1))->rows_taken, 0);
}

TEST(LiveStore, RowsAreTakenOnceAndInOrder) {
  const Folder folder;
  Press press(folder.File(), kColumns);
  const auto run = press.Begin("live");
  EXPECT_OK(Store(press, run.id, Batch(0, 100)));
  EXPECT_THAT(Store(press, run.id, Batch(50, 150)).error().text, HasSubstr("the run has rows up to 0.099 s"));
  LiveBatch backwards = Batch(100, 200);
  std::swap(backwards.raw.time[10], backwards.raw.time[11]);
  EXPECT_THAT(Store(press, run.id, std::move(backwards)).error().text,
              HasSubstr("does not increase at row 11"));
  EXPECT_EQ(Value(press.database.NewestRun(1))->rows_taken, 100);
}

TEST(LiveStore, AClockThatIsWrongByYearsBetweenTwoRunsMakesNoRowsOld) {
  const Folder folder;
  Press press(folder.File(), kColumns);
  constexpr double kYears = 10 * 365 * 86400.0;
  std::int64_t row = 0;
  for (const double clock : {0.0, kYears, 0.0}) {
    const auto run = press.Begin(fmt::format("live {}", row));
    LiveBatch batch = Batch(row, row + 1000, 0, 1);
    for (double& time : batch.raw.time) time += clock;
    EXPECT_OK(Store(press, run.id, std::move(batch), {1 << 30, 3.0}));
    row += 1000;
  }
  std::int64_t rows = 0;
  for (const RawExtent& extent : Value(press.database.RawExtents(1))) rows += extent.rows;
  EXPECT_EQ(rows, 3000);
  const auto run = press.Begin("live, later");
  for (; row < 9000; row += 1000) EXPECT_OK(Store(press, run.id, Batch(row, row + 1000), {1 << 30, 3.0}));
  rows = 0;
  for (const RawExtent& extent : Value(press.database.RawExtents(1))) rows += extent.rows;
  EXPECT_LE(rows, 5000) << "their age counts all the same";
}

TEST(LiveStore, RawRowsBeyondTheAgeGoAndTheExtentTellsThatNotAllAreKept) {
  const Folder folder;
  Press press(folder.File(), kColumns);
  const auto run = press.Begin("live");
  for (std::int64_t at = 0; at < 10'000; at += 1000)
    EXPECT_OK(Store(press, run.id, Batch(at, at + 1000), {1 << 30, 3.0}));
  const auto extents = Value(press.database.RawExtents(1));
  ASSERT_EQ(extents.size(), 1u);
  EXPECT_EQ(extents[0].rows_taken, 10'000);
  EXPECT_NEAR(extents[0].first, 6.0, 1e-9);  // the chunk that holds the limit stays
  EXPECT_LT(extents[0].rows, extents[0].rows_taken);
}

TEST(LiveStore, StrokesThatDifferInOneBitAreNamed) {
  const Folder folder;
  Press press(folder.File(), kColumns);
  const auto run = press.Begin("live");
  EXPECT_OK(Store(press, run.id, Batch(0, 100, 0, 3)));
  auto strokes = MakeStrokes(0, 4, kColumns);
  EXPECT_OK(press.database.CompareStrokes(run.id, strokes));
  strokes[1].estimates[0].value = std::nextafter(strokes[1].estimates[0].value, 1e300);
  EXPECT_THAT(press.database.CompareStrokes(run.id, strokes).error().text, HasSubstr("stroke 1"));
  strokes.resize(2);
  EXPECT_THAT(press.database.CompareStrokes(run.id, strokes).error().text, HasSubstr("3 strokes, 2"));
}

TEST(LiveStore, ValveChecksAreKeptInOrder) {
  const Folder folder;
  Press press(folder.File(), kColumns);
  ValveCheckRecord check{.outcome = "measured", .detail = "fine", .check = {}};
  check.check.time = 5;
  check.check.natural_frequency = {184, 0.2};
  check.check.dead_time = {1e-3, 2e-5};
  EXPECT_OK(press.database.AddValveCheck(1, check));
  check.outcome = "refused";
  EXPECT_OK(press.database.AddValveCheck(1, check));
  const auto checks = Value(press.database.ValveChecks(1));
  ASSERT_EQ(checks.size(), 2u);
  EXPECT_EQ(checks[0].check.time, 5);
  EXPECT_EQ(checks[0].check.natural_frequency.std, 0.2);
  EXPECT_EQ(checks[0].check.dead_time.value, 1e-3);
  EXPECT_TRUE(std::isnan(checks[0].check.gain.value));
  EXPECT_TRUE(std::isnan(checks[0].check.oil_temperature));
  EXPECT_EQ(checks[1].outcome, "refused");
}

}  // namespace
}  // namespace hydroscope
