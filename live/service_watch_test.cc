#include "live/service_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

namespace hydroscope {
namespace {

using testing::HasSubstr;

class ServiceWatchTest : public testing::Test {
 protected:
  ServiceWatchTest() {
    path_ = testing::TempDir() + "/service_watch_" +
            testing::UnitTest::GetInstance()->current_test_info()->name() + ".alarms.db";
    for (const char* end : {"", "-wal", "-shm"}) std::filesystem::remove(path_ + end);
    journal_.emplace(AlarmJournal::Open(path_).value());
  }
  ~ServiceWatchTest() override {
    journal_.reset();
    for (const char* end : {"", "-wal", "-shm"}) std::filesystem::remove(path_ + end);
  }
  std::vector<std::string> Events() {
    std::vector<std::string> events;
    const auto rows = journal_->Rows("press");
    for (const JournalRow& row : *rows) events.push_back(row.event.event + " " + row.event.alarm);
    return events;
  }

  std::string path_;
  std::optional<AlarmJournal> journal_;
  HealthBoard board_;
};

TEST_F(ServiceWatchTest, AFullDiskIsAFailureOnTheBoardAndAnAlarmUntilItIsWrittenAgain) {
  ServiceWatch watch(path_, "press", board_);
  WriterStatus writer;
  watch.Look(writer, {}, 1000);
  EXPECT_TRUE(Events().empty()) << "nothing is written while nothing changes";
  writer.state = WriterState::kDiskFull;
  writer.problem = {"press.db: the disk is full", "press.db: die Platte ist voll"};
  watch.Look(writer, {}, 1001);
  watch.Look(writer, {}, 1002);
  EXPECT_EQ(board_.Of("press/left").reason, HealthReason::kDiskFull);
  EXPECT_EQ(board_.Of("press/left").letter(), 'F');
  EXPECT_THAT(Events(), testing::ElementsAre("raised not_stored"));
  EXPECT_THAT(journal_->Rows("press").value().front().event.text, HasSubstr("the disk is full"));
  watch.Look({}, {}, 1003);
  EXPECT_THAT(Events(), testing::ElementsAre("raised not_stored", "cleared not_stored"));
  EXPECT_EQ(board_.trouble().reason, HealthReason::kJudgedGood);
}

TEST_F(ServiceWatchTest, DriftThatIsNotWatchedIsTold) {
  ServiceWatch watch(path_, "press", board_);
  watch.Look({}, {"press_rules.toml:3: unknown key"}, 1000);
  EXPECT_THAT(Events(), testing::ElementsAre("raised not_judged"));
  EXPECT_EQ(board_.Of("press/left").reason, HealthReason::kNotWatched);
  EXPECT_THAT(board_.Of("press/left").text, HasSubstr("unknown key"));
  EXPECT_THAT(board_.Of("press/left").german, HasSubstr("Drift wird nicht überwacht: "));
}

TEST_F(ServiceWatchTest, HealthIsToldAlsoWhereTheJournalCannotBeWritten) {
  ServiceWatch watch("/nowhere/press.alarms.db", "press", board_);
  WriterStatus writer;
  writer.state = WriterState::kLocked;
  watch.Look(writer, {}, 1000);
  EXPECT_EQ(board_.Of("press/left").reason, HealthReason::kDatabaseLocked);
}

}  // namespace
}  // namespace hydroscope
