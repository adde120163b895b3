#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using namespace storage_test;

constexpr std::int64_t kBatch = 7;
constexpr int kDimension = 20;

/// What the killed process does: replays the log from its start and reports each batch that was stored.
[[noreturn]] void StoreForever(const std::string& file, int acknowledge) {
  Press press(file, kDimension);
  const auto run = press.Begin("a.csv");
  std::int64_t at = run.strokes >= 2 * kBatch ? run.strokes - 2 * kBatch : 0;  // some are offered again
  for (;; at += kBatch) {
    if (!press.database.StoreStrokes(run.id, MakeStrokes(at, at + kBatch, kDimension))) _exit(2);
    const std::int64_t stored = at + kBatch;
    if (write(acknowledge, &stored, sizeof(stored)) != sizeof(stored)) _exit(3);
  }
}

enum class KillAfter { kStart, kFirstBatch };

/// The number of strokes the child reported before it was killed, `delay` after its start or its first batch.
std::int64_t AcknowledgedUntilKilled(const std::string& file, KillAfter after,
                                     std::chrono::microseconds delay) {
  int ends[2];
  EXPECT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    StoreForever(file, ends[1]);
  }
  close(ends[1]);
  std::int64_t acknowledged = 0, stored = 0;
  if (after == KillAfter::kFirstBatch) {
    EXPECT_EQ(read(ends[0], &acknowledged, sizeof(acknowledged)), ssize_t{sizeof(acknowledged)});
  }
  std::this_thread::sleep_for(delay);
  kill(child, SIGKILL);
  int state = 0;
  waitpid(child, &state, 0);
  EXPECT_TRUE(WIFSIGNALED(state)) << "the child ended by itself, exit code " << WEXITSTATUS(state);
  while (read(ends[0], &stored, sizeof(stored)) == sizeof(stored)) acknowledged = stored;
  close(ends[0]);
  return acknowledged;
}

void ExpectEveryStrokeOnce(const Database& database, std::int64_t run, std::int64_t acknowledged) {
  EXPECT_OK(database.CheckIntegrity());
  const auto strokes = Value(database.Strokes(run));
  EXPECT_GE(static_cast<std::int64_t>(strokes.size()), acknowledged);
  EXPECT_EQ(strokes.size() % kBatch, 0u) << "half a batch was stored";
  for (std::size_t i = 0; i < strokes.size(); ++i) ASSERT_EQ(strokes[i].index, static_cast<std::int64_t>(i));
  EXPECT_EQ(Value(database.Trend(1, "K")).size(), strokes.size());
}

class Kill : public testing::TestWithParam<int> {};

TEST_P(Kill, NoAcknowledgedStrokeIsLostAndNoneIsStoredTwice) {
  const Folder folder;
  std::mt19937 random(GetParam());
  std::uniform_int_distribution<int> delay(
      0, 60'000);  // us; opening takes some ms, so some kills hit the creation
  std::int64_t acknowledged = 0;
  int file = 0;
  for (int repetition = 0; repetition < GetParam(); ++repetition) {
    if (repetition % 10 ==
        0) {  // a fresh file now and then, so that files stay small and creation is hit as well
      ++file;
      acknowledged = 0;
    }
    const std::string path = folder.File(std::to_string(file));
    const KillAfter after = repetition % 3 == 0 ? KillAfter::kStart : KillAfter::kFirstBatch;
    const std::chrono::microseconds wait(delay(random));
    acknowledged = std::max(acknowledged, AcknowledgedUntilKilled(path, after, wait));
    Press press(path, kDimension);
    const auto run = press.Begin("a.csv");
    ExpectEveryStrokeOnce(press.database, run.id, acknowledged);
    acknowledged = std::max(acknowledged, run.strokes);
    ASSERT_FALSE(HasFailure()) << "repetition " << repetition;
  }

  // The survivor, continued undisturbed, equals a file that was never killed.
  const std::int64_t last = acknowledged + 50;
  std::vector<std::string> digests;
  for (const std::string& path : {folder.File(std::to_string(file)), folder.File("undisturbed.db")}) {
    Press press(path, kDimension);
    EXPECT_OK(press.database.StoreStrokes(press.Begin("a.csv").id, MakeStrokes(0, last, kDimension)));
    digests.push_back(Value(press.database.ContentDigest()));
  }
  EXPECT_EQ(digests[0], digests[1]);
}

INSTANTIATE_TEST_SUITE_P(TwentyTimes, Kill, testing::Values(20));
// The long campaign: storage_test --gtest_also_run_disabled_tests --gtest_filter='DISABLED_ThousandTimes*'
INSTANTIATE_TEST_SUITE_P(DISABLED_ThousandTimes, Kill, testing::Values(1000));

}  // namespace
}  // namespace hydroscope
