#include "page/work/stored_strokes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "pipeline/log_fingerprint.h"
#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

TEST(KeptStrokes, OfNoDatabaseAreAnError) {
  const auto none = FindKeptStrokes(testing::TempDir() + "no_such.db", {"a", 0, 1});
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().text, testing::HasSubstr("no_such.db"));
}

TEST(KeptStrokes, OfAReplayAreThoseOfItsLogWhileThatIsThere) {
  const storage_test::Folder folder;
  const std::string log = folder.File("monday.csv"), elsewhere = folder.File("elsewhere/monday.csv");
  std::ofstream(log) << "time,p_A\n0,1\n";
  {
    storage_test::Press press(folder.File());
    const std::string fingerprint =
        RunFingerprint{storage_test::Value(FingerprintLog(log)), "settings"}.Text();
    const auto run =
        storage_test::Value(press.database.BeginRun(press.machine, press.version, elsewhere, fingerprint));
    ASSERT_OK(press.database.StoreStrokes(run.id, storage_test::MakeStrokes(0, 12)));
    ASSERT_OK(press.database.FinishRun(run.id, "", {}));
  }
  const auto beside = FindKeptStrokes(folder.File(), {"press 7", 3, 5});
  ASSERT_TRUE(beside) << beside.error().text;
  ASSERT_EQ(beside->pieces.size(), 1u);
  EXPECT_EQ(beside->pieces[0].log, log);
  EXPECT_EQ(beside->pieces[0].first, 0);
  EXPECT_EQ(beside->pieces[0].last, 11);
  std::filesystem::create_directories(folder.File("elsewhere"));
  std::filesystem::copy(log, elsewhere);
  EXPECT_EQ(storage_test::Value(FindKeptStrokes(folder.File(), {"press 7", 3, 5})).pieces[0].log, elsewhere);
  for (const std::string& copy : {log, elsewhere}) std::ofstream(copy, std::ios::app) << "1,2\n";
  const auto changed = FindKeptStrokes(folder.File(), {"press 7", 3, 5});
  ASSERT_FALSE(changed);
  EXPECT_THAT(changed.error().text, testing::HasSubstr("not kept"));
}

}  // namespace
}  // namespace hydroscope
