#include "live/writer.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <thread>

#include "host/real_clock.h"
#include "live/slow_disk_fixture.h"
#include "monitor/promoted_model.h"
#include "pipeline/run_summary.h"

namespace hydroscope {
namespace {

using namespace std::chrono_literals;

/// Waits for a condition; false if it does not come true within `seconds`.
template <typename Condition>
bool Wait(double seconds, const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < end) {
    if (condition()) return true;
    std::this_thread::sleep_for(200us);
  }
  return false;
}

/// A writer of one axis with a database of its own.
class LiveWriterTest : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    ASSERT_TRUE(Database::Open(path_));  // and closed: its tables lie in the file itself, not in the log
    auto database = Database::Open(path_);
    ASSERT_TRUE(database) << database.error().text;
    LiveWriter::Axis axis;
    axis.name = "press";
    axis.model = std::make_shared<LiveModel>();
    const auto machine = database->MachineId(axis.name);
    ASSERT_TRUE(machine);
    const auto version = VersionFor(*database, *machine, {1, "", {}, 0, {}});
    ASSERT_TRUE(version) << version.error().text;
    const auto run = database->BeginRun(*machine, *version, kLiveSource, "live/press/1");
    ASSERT_TRUE(run) << run.error().text;
    axis.machine = *machine;
    axis.run = run->id;
    WriterOptions options;
    options.min_free = 0;
    writer_ = std::make_unique<LiveWriter>(std::move(*database), path_, std::vector<std::string>{},
                                           std::vector<LiveWriter::Axis>{axis}, options, RealTime,
                                           LiveWriter::Acknowledged{});
  }
  void TearDown() override {
    disk_.Release();
    EXPECT_TRUE(writer_->Stop(5));
    std::filesystem::remove_all(folder_);
  }
  /// As many steps as make a checkpoint due, each stored by itself.
  void StoreStepsToACheckpoint() {
    for (std::int64_t step = 1; step <= kStepsToACheckpoint; ++step) {
      writer_->Push(std::vector<WriteItem>(1));
      ASSERT_TRUE(Wait(10, [&] { return writer_->status().steps == step; }));
    }
  }

  static constexpr std::int64_t kStepsToACheckpoint = 128;
  SlowDisk disk_;  // outlives the writer's connections
  const std::string folder_ = fmt::format("{}writer_{}", testing::TempDir(), getpid());
  const std::string path_ = folder_ + "/press.db";
  std::unique_ptr<LiveWriter> writer_;
};

TEST_F(LiveWriterTest, TheDiskIsToldBeforeAnythingIsWritten) {
  EXPECT_TRUE(Wait(10, [&] { return writer_->status().free_bytes > 0; }));
  EXPECT_GT(writer_->status().database_bytes, 0);
}

TEST_F(LiveWriterTest, ALockThatACheckpointMeetsIsToldAsSoonAsOneThatAStepMeets) {
  constexpr double kLockSeen = 13;  // s; SQLite waits 10 s
  StoreStepsToACheckpoint();
  {
    SQLite::Database other(path_, SQLite::OPEN_READWRITE);
    other.exec("BEGIN IMMEDIATE");
    EXPECT_TRUE(Wait(kLockSeen, [&] { return writer_->status().state == WriterState::kLocked; }));
    EXPECT_EQ(writer_->status().waiting_items, 0);
  }
  EXPECT_TRUE(Wait(5, [&] { return writer_->status().state == WriterState::kWriting; }));
}

TEST_F(LiveWriterTest, StepsAreStoredWhileACheckpointWaitsForTheDisk) {
  constexpr std::int64_t kMeanwhile = 300;  // more than would begin another one
  disk_.Hold();
  StoreStepsToACheckpoint();
  ASSERT_TRUE(Wait(10, [&] { return disk_.somebody_waits(); })) << "no checkpoint came";
  for (std::int64_t step = 1; step <= kMeanwhile; ++step) {
    writer_->Push(std::vector<WriteItem>(1));
    ASSERT_TRUE(Wait(10, [&] { return writer_->status().steps == kStepsToACheckpoint + step; }))
        << "a step waits for the checkpoint";
  }
  EXPECT_TRUE(disk_.somebody_waits());
}

TEST_F(LiveWriterTest, NoStepWaitsForACheckpointOfItsOwn) {
  constexpr std::int64_t kSteps = 100;           // fewer than make a checkpoint due, in all
  constexpr std::size_t kBytesOfStep = 300'000;  // more than SQLite by itself lets wait
  disk_.Hold();
  for (std::int64_t step = 1; step <= kSteps; ++step) {
    std::vector<WriteItem> items(1);
    items.front().step.pipeline_state.resize(kBytesOfStep, static_cast<std::uint8_t>(step));
    writer_->Push(std::move(items));
    ASSERT_TRUE(Wait(5, [&] { return writer_->status().steps == step; })) << step << " waits for the disk";
  }
}

TEST_F(LiveWriterTest, ADamageIsSeenHoweverBusyItWrites) {
  std::jthread busy([this](const std::stop_token& stop) {
    while (!stop.stop_requested())
      if (writer_->status().waiting_items < 4) writer_->Push(std::vector<WriteItem>(1));
  });
  ASSERT_TRUE(Wait(10, [&] { return writer_->status().steps > 500; }));
  {
    std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(16 << 10);
    file << std::string(64 << 10, 'x');
  }
  EXPECT_TRUE(Wait(10, [&] { return writer_->status().databases == 2; }))
      << writer_->status().problem.english;
}

}  // namespace
}  // namespace hydroscope
