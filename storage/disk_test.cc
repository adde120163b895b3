#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "storage/mounted_disk.h"
#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using namespace storage_test;
using testing::HasSubstr;

constexpr const char* kNoMount =
    "mounting a small disk is not allowed here (needs root); the full disk was not tried";

void Fill(const std::string& file, std::size_t bytes) { std::ofstream(file) << std::string(bytes, 'x'); }

TEST(FullDisk, IsAnErrorThatSaysWhatToDoAndLosesNothingStored) {
  const Folder folder;
  const MountedDisk disk(folder.File("disk"), "4m");
  if (!disk.ok()) GTEST_SKIP() << kNoMount;
  const std::string file = folder.File("disk/press.db"), ballast = folder.File("disk/ballast");
  Fill(ballast, 2 << 20);

  std::int64_t stored = 0;
  Error error;
  {
    Press press(file, 30);
    const auto run = press.Begin("a.csv");
    for (;;) {
      const Status status = press.database.StoreStrokes(run.id, MakeStrokes(stored, stored + 10, 30));
      if (!status) error = status.error();
      if (!status) break;
      stored += 10;
      ASSERT_LT(stored, 1000) << "the disk never got full";
    }
    EXPECT_GT(stored, 0);
    EXPECT_EQ(error.kind, ErrorKind::kInternal);
    EXPECT_THAT(error.text, HasSubstr("the disk is full"));
    EXPECT_THAT(error.text, HasSubstr("free some space"));
    EXPECT_EQ(Value(press.database.Strokes(run.id)).size(), static_cast<std::size_t>(stored));
    EXPECT_OK(press.database.CheckIntegrity());
    EXPECT_FALSE(press.database.StoreStrokes(run.id, MakeStrokes(stored, stored + 10, 30)).has_value());

    std::filesystem::remove(ballast);
    EXPECT_OK(press.database.StoreStrokes(run.id, MakeStrokes(stored, stored + 10, 30)));
  }
  Press press(file, 30);
  const auto run = press.Begin("a.csv");
  EXPECT_EQ(run.strokes, stored + 10);
  EXPECT_OK(press.database.CheckIntegrity());

  Press undisturbed(folder.File("undisturbed.db"), 30);
  EXPECT_OK(
      undisturbed.database.StoreStrokes(undisturbed.Begin("a.csv").id, MakeStrokes(0, stored + 10, 30)));
  EXPECT_EQ(Value(press.database.ContentDigest()), Value(undisturbed.database.ContentDigest()));
}

TEST(FullDisk, AProcessEndingOnAFullDiskLeavesAGoodFile) {
  const Folder folder;
  const MountedDisk disk(folder.File("disk"), "2m");
  if (!disk.ok()) GTEST_SKIP() << kNoMount;
  const std::string file = folder.File("disk/press.db"), ballast = folder.File("disk/ballast");
  std::int64_t stored = 0;
  {
    Press press(file, 30);
    const auto run = press.Begin("a.csv");
    while (stored < 1000 && press.database.StoreStrokes(run.id, MakeStrokes(stored, stored + 1, 30)))
      ++stored;
    Fill(ballast, 4 << 20);  // whatever is left
  }
  ASSERT_LT(stored, 1000);
  std::filesystem::remove(ballast);
  const Database reader = Value(Database::OpenReadOnly(file));
  EXPECT_EQ(Value(reader.Strokes(1)).size(), static_cast<std::size_t>(stored));
  EXPECT_OK(reader.CheckIntegrity());
}

TEST(FullDisk, CreatingADatabaseThereIsAnErrorThatSaysSo) {
  const Folder folder;
  const MountedDisk disk(folder.File("disk"), "64k");
  if (!disk.ok()) GTEST_SKIP() << kNoMount;
  Fill(folder.File("disk/ballast"), 1 << 20);
  const auto opened = Database::Open(folder.File("disk/press.db"));
  ASSERT_FALSE(opened.has_value());
  EXPECT_THAT(opened.error().text, HasSubstr("the disk is full"));
  std::filesystem::remove(folder.File("disk/ballast"));
}

TEST(ReadOnlyDisk, CanBeReadAndSaysWhyItCannotBeWritten) {
  const Folder folder;
  MountedDisk disk(folder.File("disk"), "4m");
  if (!disk.ok()) GTEST_SKIP() << kNoMount;
  const std::string file = folder.File("disk/press.db");
  {
    Press press(file);
    EXPECT_OK(press.database.StoreStrokes(press.Begin("a.csv").id, MakeStrokes(0, 8)));
  }
  ASSERT_TRUE(disk.MakeReadOnly());
  const Database reader = Value(Database::OpenReadOnly(file));
  EXPECT_EQ(Value(reader.Trend(1, "K")).size(), 8u);
  const auto opened = Database::Open(file);
  ASSERT_FALSE(opened.has_value());
  EXPECT_EQ(opened.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(opened.error().text, HasSubstr("check that the folder exists and may be written"));
}

TEST(UnreadableDatabase, SaysWhoMayReadIt) {
  const Folder folder;
  const std::string file = folder.File("press.db");
  { const Press press(file); }
  chmod(file.c_str(), 0600);
  chmod(std::filesystem::path(file).parent_path().c_str(), 0755);
  const pid_t child = fork();
  if (child == 0) {  // as a user who owns nothing here
    if (setgid(65534) != 0 || setuid(65534) != 0) _exit(2);
    const auto opened = Database::OpenReadOnly(file);
    _exit(!opened && opened.error().text.find("may not be read by this user") != std::string::npos ? 0 : 1);
  }
  int state = 0;
  waitpid(child, &state, 0);
  if (WEXITSTATUS(state) == 2) GTEST_SKIP() << "only root may become another user";
  EXPECT_EQ(WEXITSTATUS(state), 0);
}

}  // namespace
}  // namespace hydroscope
