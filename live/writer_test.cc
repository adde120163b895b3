#include "live/writer.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "host/real_clock.h"
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

TEST(LiveWriter, ALockThatACheckpointMeetsIsToldAsSoonAsOneThatAStepMeets) {
  constexpr double kLockSeen = 13;  // s; SQLite waits 10 s
  constexpr int kStepsToACheckpoint = 128;
  const std::string path = testing::TempDir() + "writer.db";
  std::filesystem::remove(path);
  auto database = Database::Open(path);
  ASSERT_TRUE(database) << database.error().text;
  ASSERT_TRUE(database->LeaveCheckpointsToPauses());
  const auto machine = database->MachineId("press");
  ASSERT_TRUE(machine);
  const auto version = VersionFor(*database, *machine, {1, "", {}, 0, {}});
  ASSERT_TRUE(version) << version.error().text;
  const auto run = database->BeginRun(*machine, *version, kLiveSource, "live/press/1");
  ASSERT_TRUE(run) << run.error().text;
  LiveWriter::Axis axis;
  axis.machine = *machine;
  axis.run = run->id;
  WriterOptions options;
  options.min_free = 0;
  LiveWriter writer(std::move(*database), path, {}, {axis}, options, RealTime, {});
  for (int step = 1; step <= kStepsToACheckpoint; ++step) {
    writer.Push({});
    ASSERT_TRUE(Wait(10, [&] { return writer.status().steps == step; }));
  }
  {
    SQLite::Database other(path, SQLite::OPEN_READWRITE);
    other.exec("BEGIN IMMEDIATE");
    EXPECT_TRUE(Wait(kLockSeen, [&] { return writer.status().state == WriterState::kLocked; }));
    EXPECT_EQ(writer.status().waiting_items, 0);
  }
  EXPECT_TRUE(Wait(5, [&] { return writer.status().state == WriterState::kWriting; }));
  EXPECT_TRUE(writer.Stop(5));
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace hydroscope
