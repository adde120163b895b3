#include <algorithm>
#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "storage/database.h"
#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;

class ReplayHistory : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    for (int k = 1; k <= 3; ++k) logs_.push_back(Simulate(std::to_string(k) + ".csv", 120, k));
  }
  std::vector<std::string> Replay(const std::string& db, std::vector<std::string> logs) const {
    std::vector<std::string> words = {"replay", "-m", kMachine, "--db", db, "--json", "-"};
    words.insert(words.end(), logs.begin(), logs.end());
    return words;
  }
  static std::string Digest(const std::string& path) {
    const auto database = Database::OpenReadOnly(path);
    if (!database) return database.error().text;
    if (const Status sound = database->CheckIntegrity(); !sound) return sound.error().text;
    const auto digest = database->ContentDigest();
    return digest ? *digest : digest.error().text;
  }

  /// Strokes of a run that is under way in the database, 0 if there is none.
  static std::int64_t HalfStored(const std::string& path) {
    const auto database = Database::OpenReadOnly(path);
    if (!database) return 0;  // not created yet
    const auto runs = database->Runs(1);
    if (!runs || runs->empty() || runs->back().complete) return 0;
    return runs->back().strokes;
  }
  static std::size_t CompleteRuns(const std::string& path) {
    const auto database = Database::OpenReadOnly(path);
    const auto runs = database ? database->Runs(1) : Result<std::vector<RunInfo>>{};
    if (!runs) return 0;
    return std::count_if(runs->begin(), runs->end(), [](const RunInfo& run) { return run.complete; });
  }
  /// Starts a replay and kills it once it has stored part of a log; false if it came to its end before.
  bool KillWithinALog(const std::vector<std::string>& words) {
    const pid_t child = Start(words);
    int state = 0;
    while (waitpid(child, &state, WNOHANG) == 0) {
      if (HalfStored(words[4]) > 0) kill(child, SIGKILL);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return WIFSIGNALED(state) && HalfStored(words[4]) > 0;
  }

  std::vector<std::string> logs_;
};

TEST_F(ReplayHistory, TwoReplaysIntoFreshDatabasesAreTheSame) {
  ASSERT_EQ(Run(Replay(File("a.db"), logs_)).exit_code, 0);
  ASSERT_EQ(Run(Replay(File("b.db"), logs_)).exit_code, 0);
  EXPECT_EQ(Digest(File("a.db")).size(), 16u);
  EXPECT_EQ(Digest(File("a.db")), Digest(File("b.db")));
}

TEST_F(ReplayHistory, LogByLogIsTheSameAsAllAtOnceAndNothingIsStoredTwice) {
  ASSERT_EQ(Run(Replay(File("a.db"), logs_)).exit_code, 0);
  for (const std::string& log : logs_) ASSERT_EQ(Run(Replay(File("b.db"), {log})).exit_code, 0);
  EXPECT_EQ(Digest(File("a.db")), Digest(File("b.db")));
  const Ran again = Run(Replay(File("b.db"), logs_));
  EXPECT_EQ(again.exit_code, 0);
  for (const auto& log : again.Json()["logs"]) EXPECT_EQ(log["status"], "already_replayed");
  EXPECT_EQ(Digest(File("a.db")), Digest(File("b.db")));
}

TEST_F(ReplayHistory, AKilledReplayContinuesToTheSameContent) {
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(Run(Replay(File("whole.db"), logs_)).exit_code, 0);
  const auto whole = std::chrono::steady_clock::now() - start;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0.02, 0.9);
  int killed = 0;
  for (int repetition = 0; repetition < 8; ++repetition) {
    const pid_t child = Start(Replay(File("killed.db"), logs_));
    std::this_thread::sleep_for(share(random) * whole);
    kill(child, SIGKILL);
    int state = 0;
    waitpid(child, &state, 0);
    killed += WIFSIGNALED(state) ? 1 : 0;
  }
  EXPECT_GE(killed, 2) << "the replay was too fast to be killed";
  const Ran last = Run(Replay(File("killed.db"), logs_));
  EXPECT_EQ(last.exit_code, 0) << last.err;
  EXPECT_EQ(Digest(File("killed.db")), Digest(File("whole.db")));
}

TEST_F(ReplayHistory, AReplayKilledWithinALogKeepsItsStrokesAndAddsTheRest) {
  const std::vector<std::string> logs = {logs_[0], Simulate("long.csv", 900, 9), logs_[1]};
  ASSERT_EQ(Run(Replay(File("whole.db"), logs)).exit_code, 0);
  bool within = false;
  for (int attempt = 0; attempt < 10 && !within; ++attempt) {
    for (const char* end : {"", "-wal", "-shm"}) std::filesystem::remove(File("killed.db") + end);
    within = KillWithinALog(Replay(File("killed.db"), logs));
  }
  ASSERT_TRUE(within) << "no replay could be stopped within a log";
  const std::int64_t stored = HalfStored(File("killed.db"));
  const std::size_t halted = CompleteRuns(File("killed.db"));  // index of the log the kill fell into
  const Ran last = Run(Replay(File("killed.db"), logs));
  EXPECT_EQ(last.exit_code, 0) << last.err;
  const auto results = last.Json()["logs"];
  for (std::size_t log = 0; log < logs.size(); ++log)
    EXPECT_EQ(results[log]["status"],
              log < halted ? "already_replayed" : (log == halted ? "continued" : "replayed"));
  EXPECT_EQ(results[halted]["strokes_stored_before"], stored);
  EXPECT_GE(results[halted]["strokes"], stored);
  EXPECT_EQ(Digest(File("killed.db")), Digest(File("whole.db")));
}

TEST_F(ReplayHistory, ALogThatHasGrownIsNotCountedTwice) {
  const std::string whole = ReadText(logs_[0]);
  WriteText(File("growing.csv"), whole.substr(0, whole.rfind('\n', whole.size() / 2) + 1));
  ASSERT_EQ(Run(Replay(File("a.db"), {File("growing.csv")})).exit_code, 0);
  WriteText(File("growing.csv"), whole);
  const Ran ran = Run(Replay(File("a.db"), {File("growing.csv"), logs_[1]}));
  EXPECT_EQ(ran.exit_code, 4);
  EXPECT_THAT(ran.err, testing::HasSubstr("has grown"));
  EXPECT_EQ(ran.Json()["runs"], 2);
}

TEST_F(ReplayHistory, OtherLimitsAreTheSameRunOtherGateIsNot) {
  ASSERT_EQ(Run(Replay(File("a.db"), {logs_[0]})).exit_code, 0);
  const std::string machine = ReadText(kMachine);
  std::vector<std::string> words = Replay(File("a.db"), {logs_[0]});
  words[2] = File("m.toml");
  WriteText(words[2], machine + "\n[monitor.K]\nunit = \"GPa\"\nwarn_low = 1.0\n");
  const Ran limits = Run(words);
  EXPECT_EQ(limits.exit_code, 0) << limits.err;
  EXPECT_EQ(limits.Json()["logs"][0]["status"], "already_replayed");
  std::string gate = machine;
  const auto at = gate.find("min = 0.04 }, \"ddt");
  ASSERT_NE(at, std::string::npos);
  WriteText(words[2], gate.replace(at, 10, "min = 0.06"));
  const Ran other = Run(words);
  EXPECT_EQ(other.exit_code, 3);
  EXPECT_THAT(other.err, testing::HasSubstr("new database"));
}

}  // namespace
}  // namespace hydroscope
