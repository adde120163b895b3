#include "storage/alarm_journal.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>

namespace {
std::atomic<int> waits_for_disk = 0;
}
/// In place of the system's, for SQLite too.
extern "C" int fdatasync(int file) {
  ++waits_for_disk;
  return static_cast<int>(syscall(SYS_fdatasync, file));
}

namespace hydroscope {
namespace {

class AlarmJournalFile : public ::testing::Test {
 protected:
  void SetUp() override {
    path =
        (std::filesystem::path(::testing::TempDir()) /
         (std::string("journal_") + ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".db"))
            .string();
    for (const char* end : {"", "-wal", "-shm"}) std::filesystem::remove(path + end);
  }
  /// Raises an alarm with `text`.
  static Status Raise(AlarmJournal& journal, const std::string& machine, const std::string& text) {
    return journal.Change(machine, 12.5, [&](AxisContent& axis) -> Status {
      AlarmState& alarm = axis.Alarm("leak");
      alarm.active = true;
      alarm.acknowledged = false;
      alarm.text = text;
      AlarmEvent event;
      event.alarm = "leak";
      event.event = "raised";
      event.text = text;
      axis.events.push_back(event);
      axis.monitor = {axis.monitor.next_stroke + 1, 3, {1, 2, 3}};
      return {};
    });
  }
  std::string path;
};

TEST_F(AlarmJournalFile, KeepsWhatAnAlarmSaysInBothLanguages) {
  const AlarmWords words{{"Oil column softer", "Ölsäule weicher"},
                         {"since stroke 481", "seit Hub 481"},
                         {"Bleed the cylinder.", "Den Zylinder entlüften."}};
  {
    auto journal = AlarmJournal::Open(path);
    ASSERT_TRUE(journal) << journal.error().text;
    const Status told = journal->Change("press", 12.5, [&](AxisContent& axis) -> Status {
      axis.Alarm("entrained_air").words = words;
      axis.Alarm("entrained_air").quantities = {"K", "V0"};
      return {};
    });
    ASSERT_TRUE(told) << told.error().text;
  }
  const auto journal = AlarmJournal::Open(path);
  ASSERT_TRUE(journal) << journal.error().text;
  const auto axis = journal->Axis("press");
  ASSERT_TRUE(axis) << axis.error().text;
  ASSERT_EQ(axis->alarms.size(), 1u);
  EXPECT_EQ(axis->alarms.front().words, words);
  EXPECT_EQ(axis->alarms.front().quantities, (std::vector<std::string>{"K", "V0"}));
}

/// As another user, who may read the file but neither write it nor make files beside it.
TEST_F(AlarmJournalFile, IsReadWithoutTheRightToWrite) {
  const std::string folder = path + ".d";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  path = folder + "/press.alarms.db";
  {
    auto journal = AlarmJournal::Open(path);
    ASSERT_TRUE(journal) << journal.error().text;
    ASSERT_TRUE(Raise(*journal, "press", "one"));
  }
  std::filesystem::permissions(path, std::filesystem::perms(0444));
  std::filesystem::permissions(folder, std::filesystem::perms(0555));
  if (geteuid() == 0 && seteuid(65534) != 0) GTEST_SKIP() << "no other user to be";
  {
    auto journal = AlarmJournal::OpenReadOnly(path);
    EXPECT_TRUE(journal) << journal.error().text;
    if (journal) {
      EXPECT_EQ(journal->Rows("")->size(), 1u);
      EXPECT_FALSE(Raise(*journal, "press", "two"));
    }
  }
  if (getuid() == 0) {
    ASSERT_EQ(seteuid(0), 0);
  }
  std::filesystem::permissions(folder, std::filesystem::perms(0755));
  std::filesystem::remove_all(folder);
}

/// Whether this process has any lock on a file, as another one sees it.
bool IsLocked(const std::string& path) {
  const pid_t child = fork();
  if (child == 0) {
    struct flock lock {};
    lock.l_type = F_WRLCK;
    lock.l_whence = SEEK_SET;
    const int file = open(path.c_str(), O_RDWR | O_CLOEXEC);
    _exit(file >= 0 && fcntl(file, F_GETLK, &lock) == 0 && lock.l_type != F_UNLCK ? 1 : 0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 1;
}

TEST_F(AlarmJournalFile, ItsLocksSurviveThatTheSameProcessOpensItAgain) {
  auto journal = AlarmJournal::Open(path);
  ASSERT_TRUE(journal) << journal.error().text;
  ASSERT_TRUE(Raise(*journal, "press", "one"));
  ASSERT_TRUE(IsLocked(path));
  { EXPECT_TRUE(AlarmJournal::Open(path)); }
  EXPECT_TRUE(IsLocked(path)) << "another process would take the file for its own";
}

TEST_F(AlarmJournalFile, KeepsRowsStatesAndMonitorOverARestart) {
  {
    auto journal = AlarmJournal::Open(path);
    ASSERT_TRUE(journal) << journal.error().text;
    ASSERT_TRUE(Raise(*journal, "press", "one"));
    ASSERT_TRUE(Raise(*journal, "other", "two"));
    ASSERT_TRUE(Raise(*journal, "press", "three"));
  }
  auto journal = AlarmJournal::OpenExisting(path);
  ASSERT_TRUE(journal);
  const auto rows = journal->Rows("");
  ASSERT_TRUE(rows);
  ASSERT_EQ(rows->size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ((*rows)[i].sequence, static_cast<std::int64_t>(i + 1));
  EXPECT_EQ((*rows)[2].event.text, "three");
  EXPECT_EQ((*rows)[2].wall, 12.5);
  EXPECT_EQ(journal->Rows("press", 1)->size(), 1u);
  const auto axis = journal->Axis("press");
  ASSERT_EQ(axis->alarms.size(), 1u);
  EXPECT_STREQ(StateName(axis->alarms[0]), "UNACK");
  EXPECT_EQ(axis->monitor.next_stroke, 2);
  EXPECT_EQ(axis->monitor.state, (std::vector<std::uint8_t>{1, 2, 3}));
  EXPECT_TRUE(journal->CheckIntegrity());
}

TEST_F(AlarmJournalFile, StoresNothingOfAChangeThatFails) {
  auto journal = AlarmJournal::Open(path);
  ASSERT_TRUE(Raise(*journal, "press", "one"));
  const Status failed = journal->Change("press", 1, [](AxisContent& axis) -> Status {
    axis.Alarm("leak").active = false;
    axis.events.emplace_back();
    return BadInput("no");
  });
  EXPECT_FALSE(failed);
  EXPECT_EQ(journal->Rows("")->size(), 1u);
  EXPECT_TRUE(journal->Axis("press")->alarms[0].active);
}

TEST_F(AlarmJournalFile, WaitsForTheDiskWhereAnAlarmIsToldAndNotAtEveryStroke) {
  auto journal = AlarmJournal::Open(path);
  ASSERT_TRUE(Raise(*journal, "press", "one"));
  const auto judge = [&](std::int64_t stroke) {
    return journal->Change("press", 1, [&](AxisContent& axis) -> Status {
      axis.monitor = {stroke, 3, {4, 5, 6}};
      return {};
    });
  };
  int before = waits_for_disk;
  for (std::int64_t stroke = 10; stroke < 60; ++stroke) ASSERT_TRUE(judge(stroke));
  EXPECT_EQ(waits_for_disk - before, 0);
  before = waits_for_disk;
  ASSERT_TRUE(Raise(*journal, "press", "two"));
  EXPECT_EQ(waits_for_disk - before, 1);
}

TEST_F(AlarmJournalFile, RefusesToChangeOrDeleteARow) {
  auto journal = AlarmJournal::Open(path);
  ASSERT_TRUE(Raise(*journal, "press", "one"));
  SQLite::Database db(path, SQLite::OPEN_READWRITE);
  EXPECT_THROW(db.exec("UPDATE journal SET text = 'x'"), SQLite::Exception);
  EXPECT_THROW(db.exec("DELETE FROM journal"), SQLite::Exception);
}

TEST_F(AlarmJournalFile, LeavesForeignAndNewerFilesAlone) {
  {
    SQLite::Database db(path, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    db.exec("CREATE TABLE x(y); PRAGMA application_id = 7");
  }
  const auto foreign = AlarmJournal::Open(path);
  ASSERT_FALSE(foreign);
  EXPECT_NE(foreign.error().text.find("no alarm journal"), std::string::npos);
}

TEST_F(AlarmJournalFile, LiesBesideTheDatabase) {
  EXPECT_EQ(AlarmJournal::PathFor("/data/press.db"), "/data/press.alarms.db");
  EXPECT_EQ(AlarmJournal::PathFor("press"), "press.alarms");
}

}  // namespace
}  // namespace hydroscope
