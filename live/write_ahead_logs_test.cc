#include "live/write_ahead_logs.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "storage/database.h"

namespace hydroscope {
namespace {

TEST(WriteAheadLogs, OneThatIsDeletedUnderAnOpenDatabaseIsNamed) {
  const std::string path = testing::TempDir() + "/write_ahead.db";
  for (const char* ending : {"", "-wal", "-shm"}) std::filesystem::remove(path + ending);
  auto database = Database::Open(path);
  ASSERT_TRUE(database) << database.error().text;
  ASSERT_TRUE(database->MachineId("press"));
  WriteAheadLogs logs({path}), not_asked_before({path});
  EXPECT_EQ(logs.Gone(), "");
  std::filesystem::remove(path + "-wal");
  EXPECT_EQ(not_asked_before.Gone(), path + "-wal");
  EXPECT_EQ(logs.Gone(), path + "-wal");
  std::filesystem::remove(path);
  EXPECT_EQ(logs.Gone(), "") << "the database itself is gone, which others tell";
}

}  // namespace
}  // namespace hydroscope
