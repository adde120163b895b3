#include "page/work/region.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hydroscope {
namespace {

TEST(Region, IsReadAsThePageWritesIt) {
  const auto region = ParseRegion("p_A:33.4:85|speed:-40.5:-3.5e1");
  ASSERT_TRUE(region);
  ASSERT_EQ(region->size(), 2u);
  EXPECT_EQ((*region)[0].signal, "p_A");
  EXPECT_EQ((*region)[0].to, 85);
  EXPECT_EQ((*region)[1].from, -40.5);
  EXPECT_EQ((*region)[1].to, -35);
  EXPECT_TRUE(ParseRegion("")->empty()) << "everything";
}

TEST(Region, SaysWhatIsWrongWithIt) {
  for (const char* text :
       {"p_A", "p_A:1", ":1:2", "::", "p_A:1:", "p_A:a:2", "p_A:1:inf", "p_A:1:nan", "p_A:1:2|y",
        "p_A:1:2|p_A:1:2|p_A:1:2|p_A:1:2|p_A:1:2|p_A:1:2|p_A:1:2|p_A:1:2|p_A:1:2"}) {
    const auto region = ParseRegion(text);
    ASSERT_FALSE(region) << text;
    EXPECT_THAT(region.error().text, testing::StartsWith("where: "));
  }
}

}  // namespace
}  // namespace hydroscope
