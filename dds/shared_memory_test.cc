#include "dds/shared_memory.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <fstream>
#include <set>

namespace hydroscope {
namespace {

namespace fs = std::filesystem;

class SharedMemory : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  void Make(const std::string& name) { std::ofstream(folder_ / name) << "x"; }
  bool There(const std::string& name) const { return fs::exists(folder_ / name); }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("shm-" + std::to_string(getpid()));
};

TEST_F(SharedMemory, WhatAKilledProcessLeftIsRemoved) {
  for (const char* name :
       {"fastrtps_0aa0df61ca8c2e05", "fastrtps_0aa0df61ca8c2e05_el", "fastrtps_port2685551649",
        "fastrtps_port2685551649_el", "sem.fastrtps_port2685551649_mutex"})
    Make(name);
  EXPECT_EQ(RemoveDeadSharedMemory(folder_, 0), 5);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(SharedMemory, WhatALivingProcessHoldsStays) {
  Make("fastrtps_0aa0df61ca8c2e05");
  Make("fastrtps_0aa0df61ca8c2e05_el");
  Make("fastrtps_port27650");
  Make("fastrtps_port27650_sl");
  const int exclusive = open((folder_ / "fastrtps_0aa0df61ca8c2e05_el").c_str(), O_RDONLY);
  const int shared = open((folder_ / "fastrtps_port27650_sl").c_str(), O_RDONLY);
  ASSERT_EQ(flock(exclusive, LOCK_EX | LOCK_NB), 0);
  ASSERT_EQ(flock(shared, LOCK_SH | LOCK_NB), 0);
  EXPECT_EQ(RemoveDeadSharedMemory(folder_, 0), 0);
  close(exclusive);
  EXPECT_EQ(RemoveDeadSharedMemory(folder_, 0), 2);
  EXPECT_TRUE(There("fastrtps_port27650"));
  close(shared);
}

TEST_F(SharedMemory, WhatIsYoungOrNotOfTheLibraryStays) {
  Make("fastrtps_0aa0df61ca8c2e05");
  Make("fastrtps_0aa0df61ca8c2e05_el");
  Make("another_program");
  EXPECT_EQ(RemoveDeadSharedMemory(folder_, 10), 0);
  EXPECT_EQ(RemoveDeadSharedMemory(folder_, 0), 2);
  EXPECT_TRUE(There("another_program"));
}

TEST_F(SharedMemory, TellsWhoseLivingProcessesUseIt) {
  Make("fastrtps_0aa0df61ca8c2e05");
  Make("fastrtps_0aa0df61ca8c2e05_el");
  EXPECT_FALSE(UsersOfSharedMemory(folder_).own) << "its process is dead";
  const int lock = open((folder_ / "fastrtps_0aa0df61ca8c2e05_el").c_str(), O_RDONLY);
  ASSERT_EQ(flock(lock, LOCK_EX | LOCK_NB), 0);
  EXPECT_TRUE(UsersOfSharedMemory(folder_).own);
  EXPECT_EQ(UsersOfSharedMemory(folder_).other, "");
  if (chown((folder_ / "fastrtps_0aa0df61ca8c2e05_el").c_str(), 65534, 65534) == 0) {
    EXPECT_EQ(UsersOfSharedMemory(folder_).other, "nobody");
    EXPECT_FALSE(UsersOfSharedMemory(folder_).own);
  }
  close(lock);
}

TEST_F(SharedMemory, ASegmentWithoutALockMayBeInTheMaking) {
  Make("fastrtps_0aa0df61ca8c2e05");
  EXPECT_EQ(RemoveDeadSharedMemory(folder_, 0), 0);
}

TEST(SharedMemoryPort, IsAnotherOneEachTimeAndAboveThoseOfTheLibrary) {
  std::set<std::uint32_t> ports;
  for (int k = 0; k < 100; ++k) ports.insert(UnusedSharedMemoryPort());
  EXPECT_EQ(ports.size(), 100u);
  EXPECT_GT(*ports.begin(), 65535u);
}

}  // namespace
}  // namespace hydroscope
