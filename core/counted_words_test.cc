#include "core/counted_words.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

TEST(Counted, OneIsSingular) {
  EXPECT_EQ(Counted(1, "log"), "1 log");
  EXPECT_EQ(Counted(0, "log"), "0 logs");
  EXPECT_EQ(Counted(std::size_t{3}, "row"), "3 rows");
  EXPECT_EQ(kEpisodes.Counted(1), "1 episode");
  EXPECT_EQ(CountedWords{}.Counted(2), "2 strokes");
  EXPECT_EQ(kEpisodes.CountedTold(1), Told("1 episode", "1 Episode"));
  EXPECT_EQ(CountedWords{}.CountedTold(3), Told("3 strokes", "3 Hübe"));
}

}  // namespace
}  // namespace hydroscope
