#include "storage/outbox.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace hydroscope {
namespace {

using ::testing::HasSubstr;

class OutboxTest : public testing::Test {
 protected:
  OutboxTest() { std::filesystem::remove(path_); }
  ~OutboxTest() override { std::filesystem::remove(path_); }
  Outbox Opened() {
    auto outbox = Outbox::Open(path_);
    if (!outbox) throw std::runtime_error(outbox.error().text);
    return std::move(*outbox);
  }
  static OutboxItem Item(std::int64_t sequence) { return {sequence, "topic", std::string("a\0b", 3)}; }
  static std::vector<std::int64_t> Waiting(const Outbox& outbox) {
    std::vector<std::int64_t> sequences;
    const auto items = outbox.Items(0, 100);
    for (const OutboxItem& item : *items) sequences.push_back(item.sequence);
    return sequences;
  }

  const std::string path_ =
      testing::TempDir() + "/outbox_" + testing::UnitTest::GetInstance()->current_test_info()->name() + ".db";
};

TEST_F(OutboxTest, LiesBesideTheDatabase) { EXPECT_EQ(Outbox::PathFor("/a/press.db"), "/a/press.outbox.db"); }

TEST_F(OutboxTest, KeepsItemsAndCursorUntilTheyAreRemoved) {
  ASSERT_TRUE(Opened().Put({Item(2), Item(5)}, 7));
  Outbox again = Opened();
  EXPECT_EQ(*again.Cursor(), 7);
  EXPECT_THAT(Waiting(again), testing::ElementsAre(2, 5));
  EXPECT_EQ(again.Items(2, 1)->front().payload, std::string("a\0b", 3));
  ASSERT_TRUE(again.Remove({2}));
  EXPECT_EQ(*again.Count(), 1);
  EXPECT_THAT(Waiting(again), testing::ElementsAre(5));
}

TEST_F(OutboxTest, TakesNoItemTwice) {
  Outbox outbox = Opened();
  ASSERT_TRUE(outbox.Put({Item(2)}, 2));
  ASSERT_TRUE(outbox.Remove({2}));
  EXPECT_FALSE(outbox.Put({Item(2)}, 3));
  EXPECT_FALSE(outbox.Put({Item(4), Item(3)}, 4));
  EXPECT_FALSE(outbox.Put({Item(4)}, 3));
  EXPECT_EQ(*outbox.Cursor(), 2);
  EXPECT_EQ(*outbox.Count(), 0);
}

TEST_F(OutboxTest, EveryBirthHasItsNumberOverAllLives) {
  EXPECT_EQ(*Opened().NextBirth(), 0);
  Outbox outbox = Opened();
  for (int k = 1; k < 256; ++k) EXPECT_EQ(*outbox.NextBirth(), k);
  EXPECT_EQ(*outbox.NextBirth(), 0);
}

TEST_F(OutboxTest, AFileOfAnotherKindIsLeftAsItIs) {
  std::ofstream(path_) << std::string(4096, 'x');
  EXPECT_FALSE(Outbox::Open(path_));
  EXPECT_EQ(std::filesystem::file_size(path_), 4096u);
}

}  // namespace
}  // namespace hydroscope
