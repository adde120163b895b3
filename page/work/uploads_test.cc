#include "page/work/uploads.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace hydroscope {
namespace {

TEST(Uploads, AreLimitedTogetherAndGiveTheirRoomBackWithTheLastThatHoldsThem) {
  const std::string folder = testing::TempDir() + "uploads_test";
  std::filesystem::remove_all(folder);
  Uploads uploads(folder, 1000);
  EXPECT_TRUE(uploads.MayTake(1000));
  const std::string coming = uploads.NewFile();
  std::ofstream(coming).close();
  std::filesystem::resize_file(coming, 600);  // as the server does before the body is there
  EXPECT_TRUE(uploads.MayTake(400));
  const Status refused = uploads.MayTake(401);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text, testing::HasSubstr("together"));
  auto kept = uploads.Keep(coming, "press.csv");
  ASSERT_TRUE(kept) << kept.error().text;
  EXPECT_FALSE(uploads.MayTake(401));
  kept->reset();
  EXPECT_TRUE(uploads.MayTake(1000));
}

TEST(Uploads, TakeNothingThatTheDiskHasNoRoomFor) {
  const std::string folder = testing::TempDir() + "uploads_disk_test";
  const Uploads uploads(folder, std::int64_t{1} << 62);
  const Status refused = uploads.MayTake(std::int64_t{1} << 60);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text, testing::HasSubstr("does not fit onto the disk"));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace hydroscope
