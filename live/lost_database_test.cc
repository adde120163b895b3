#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "live/live_service_fixture.h"
#include "storage/database.h"

namespace hydroscope {
namespace {

using namespace live_service_test;
using testing::HasSubstr;

/// What befalls the database's file while the service runs. Times are those of the played clock.
class LostDatabaseTest : public LiveServiceTest {
 protected:
  /// Strokes are stored when this happens, and most of the log is still to come.
  void BeginUntil(const std::function<void()>& mishap) {
    PlayedSource::hold_at = 12'000;
    Begin();
    mishap();
    PlayedSource::hold_at = PlayedSource::kNever;
  }
  /// Plays to the end. All strokes but those of the first database are in the second one, and what of it can be
  /// replayed gives the same.
  void ExpectTheRestInTheSecondDatabase() {
    ASSERT_TRUE(WaitFor([](const WriterStatus& w) {
      return w.databases == 2 && w.state == WriterState::kWriting;
    })) << service_->status().writer.problem.english;
    while (!PlayedSource::done) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_TRUE(service_->Stop());
    const LiveStatus last = service_->status();
    EXPECT_EQ(last.writer.dropped_strokes + last.writer.dropped_rows + last.writer.refused, 0);
    auto database = Database::Open(options_.database);
    ASSERT_TRUE(database) << database.error().text;
    std::int64_t stored = 0, all = 0;
    for (const AxisStatus& axis : last.axes) {
      all += axis.strokes;
      stored += *database->EndSequence(*database->MachineId(axis.name));
    }
    EXPECT_GT(stored, 0);
    // Strokes under way at the end are ended by Stop.
    EXPECT_EQ(last.writer.strokes, stored + strokes_before_);
    EXPECT_GE(last.writer.strokes, all);
    const auto verified = VerifyLive(options_.database);
    ASSERT_TRUE(verified) << verified.error().text;
    std::int64_t same = 0;
    for (const VerifiedRun& run : *verified) {
      EXPECT_NE(run.outcome, VerifiedRun::Outcome::kDiffers) << run.axis << ": " << run.detail;
      same += run.outcome == VerifiedRun::Outcome::kSame;
    }
    EXPECT_GE(same, 2) << "one of each axis";
  }

  std::int64_t strokes_before_ = 0;  ///< stored in the first database
};

TEST_F(LostDatabaseTest, OneThatIsDeletedIsBegunAnewWithWhatMemoryHolds) {
  options_.writer.anew_after = 2;
  BeginUntil([this] {
    for (const char* part : {"", "-wal", "-shm"}) std::filesystem::remove(options_.database + part);
  });
  ASSERT_TRUE(
      WaitFor([](const WriterStatus& w) { return w.state == WriterState::kGone || w.databases == 2; }));
  // While it is gone nothing is stored; a step may have been under way when it was deleted.
  ASSERT_TRUE(WaitFor([&](const WriterStatus& w) {
    strokes_before_ = w.databases == 1 ? w.strokes : strokes_before_;
    return w.databases == 2;
  }));
  EXPECT_THAT(service_->status().writer.begun_anew.english, HasSubstr("deleted, moved or replaced"));
  ExpectTheRestInTheSecondDatabase();
}

TEST_F(LostDatabaseTest, OneThatIsDamagedIsSetAsideAndBegunAnew) {
  Serve(0, 8'000);  // what it stored lies in the file itself, not in the write-ahead log
  BeginUntil([this] {
    {
      std::fstream file(options_.database, std::ios::in | std::ios::out | std::ios::binary);
      file.seekp(16 << 10);
      file << std::string(64 << 10, 'x');  // as a stray `dd` does
    }
    ASSERT_TRUE(WaitFor([this](const WriterStatus& w) {
      strokes_before_ = w.databases == 1 ? w.strokes : strokes_before_;
      return w.databases == 2;
    })) << service_->status().writer.problem.english;
  });
  EXPECT_THAT(service_->status().writer.begun_anew.english, HasSubstr("is kept as"));
  int kept = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder_))
    kept += file.path().filename().string().starts_with("press.20") && file.path().extension() == ".db";
  EXPECT_EQ(kept, 1);
  ExpectTheRestInTheSecondDatabase();
}

TEST_F(LostDatabaseTest, OneThatIsReplacedByACopyIsWrittenOn) {
  options_.writer.anew_after = 2;
  Serve(0, 5'000);
  std::filesystem::copy_file(options_.database, File("copy.db"));
  BeginUntil([this] { std::filesystem::rename(File("copy.db"), options_.database); });
  ASSERT_TRUE(WaitFor([](const WriterStatus& w) { return w.databases == 2; }));
  EXPECT_TRUE(service_->Stop());
  EXPECT_EQ(service_->status().writer.refused, 0);
  EXPECT_TRUE(Database::Open(options_.database)->CheckIntegrity());
}

TEST_F(LiveServiceTest, ADatabaseThatIsMovedAwayIsToldAndWrittenAgainWhenItIsBack) {
  options_.writer.anew_after = 1e9;
  PlayedSource::done = false;
  auto service = ServiceOn(0, 25'000, 0);
  ASSERT_TRUE(service) << service.error().text;
  std::filesystem::rename(File("press.db"), File("elsewhere.db"));
  EXPECT_OK((*service)->Start());
  const auto wait_for = [&](const auto& reached) {
    for (int k = 0; k < 1000 && !reached((*service)->status().writer); ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return (*service)->status().writer;
  };
  const WriterStatus gone = wait_for([](const WriterStatus& w) { return w.state == WriterState::kGone; });
  EXPECT_EQ(gone.state, WriterState::kGone);
  EXPECT_THAT(gone.problem.english, HasSubstr("deleted, moved or replaced"));
  EXPECT_EQ(gone.steps, 0);
  std::filesystem::rename(File("elsewhere.db"), File("press.db"));
  const WriterStatus back =
      wait_for([](const WriterStatus& w) { return w.state == WriterState::kWriting && w.rows > 0; });
  EXPECT_EQ(back.state, WriterState::kWriting);
  EXPECT_GT(back.rows, 0);
  EXPECT_TRUE((*service)->Stop());
}

}  // namespace
}  // namespace hydroscope
