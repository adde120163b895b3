#include "workbench/history/block_estimates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <optional>

#include "studies/simulated_strokes.h"

namespace hydroscope {
namespace {

class BlockEstimatesTest : public testing::Test {
 protected:
  /// A simulated log in a database of its own.
  void Store(const PressOptions& press, const Machine& machine) {
    const auto log = StrokesOf(SimulatePress(press), machine);
    ASSERT_TRUE(log) << log.error().text;
    const std::string path =
        testing::TempDir() + testing::UnitTest::GetInstance()->current_test_info()->name() + ".db";
    for (const char* suffix : {"", "-wal", "-shm"}) std::filesystem::remove(path + suffix);
    auto database = Database::Open(path);
    ASSERT_TRUE(database) << database.error().text;
    database_.emplace(std::move(*database));
    id_ = database_->MachineId(machine.name).value();
    const int version =
        database_->PutModelVersion(id_, {1, FormatMachine(machine), log->model->ColumnNames()}).value();
    const auto run = database_->BeginRun(id_, version, "log", "fingerprint");
    ASSERT_TRUE(run) << run.error().text;
    ASSERT_TRUE(database_->StoreStrokes(run->id, log->strokes));
    for (const StrokeRecord& record : log->strokes) strokes_.push_back(record.summary);
  }

  std::optional<Database> database_;
  std::int64_t id_ = 0;
  std::vector<StrokeSummary> strokes_;
};

TEST_F(BlockEstimatesTest, CoverAllStrokesOnceAndScatterAboutTheTruthAsTheySay) {
  PressOptions press;
  press.seconds = 240;
  press.oil_start = 300;
  press.oil_end = 310;
  Machine machine = MachineFor(press);
  machine.log.sample_period = press.sample_period;
  Store(press, machine);
  const auto blocks = EstimateBlocks(*database_, id_, machine, strokes_);
  ASSERT_TRUE(blocks) << blocks.error().text;
  ASSERT_GE(blocks->size(), 10u);
  EXPECT_EQ(blocks->front().first, 0);
  EXPECT_EQ(blocks->back().last, static_cast<std::int64_t>(strokes_.size()));
  double square = 0;
  for (std::size_t k = 0; k < blocks->size(); ++k) {
    const BlockEstimates& block = (*blocks)[k];
    if (k > 0) {
      EXPECT_EQ(block.first, (*blocks)[k - 1].last);
      EXPECT_GT(block.oil_temperature, (*blocks)[k - 1].oil_temperature);
    }
    EXPECT_GE(block.last - block.first, kLeastBlockStrokes);
    const Estimate& flow = block.parameters.at(2);
    EXPECT_EQ(flow.parameter, "Q_vn");
    square += std::pow((flow.value - press.machine.Q_vn) / flow.std, 2);
  }
  EXPECT_LT(square / static_cast<double>(blocks->size()), 4);
}

TEST_F(BlockEstimatesTest, RefuseStrokesRecordedWithOtherColumns) {
  PressOptions press;
  press.seconds = 30;
  Machine machine = MachineFor(press);
  machine.log.sample_period = press.sample_period;
  Store(press, machine);
  std::erase_if(machine.signals, [](const SignalSpec& signal) { return signal.name == "T_oil"; });
  EXPECT_FALSE(EstimateBlocks(*database_, id_, machine, strokes_));
}

}  // namespace
}  // namespace hydroscope
