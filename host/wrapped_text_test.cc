#include "host/wrapped_text.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

TEST(WrappedText, LeavesShortLinesAlone) {
  EXPECT_EQ(WrappedText("one\n\n  two  three\n", 20), "one\n\n  two  three\n");
  EXPECT_EQ(WrappedText("no end", 20), "no end");
}

TEST(WrappedText, BreaksLongLinesAtBlanksAndIndentsWhatFollows) {
  EXPECT_EQ(WrappedText("  the model misses something\n", 20), "  the model misses\n      something\n");
  EXPECT_EQ(WrappedText("a b c d e f g h", 8), "a b c d\n    e f\n    g h");
}

TEST(WrappedText, CountsCharactersNotBytes) {
  EXPECT_EQ(WrappedText("±±±± ±±±±\n", 9), "±±±± ±±±±\n");
  EXPECT_EQ(WrappedText("±±±± ±±±±\n", 8), "±±±±\n    ±±±±\n");
}

TEST(WrappedText, KeepsLongWordsAndCommandsWhole) {
  EXPECT_EQ(WrappedText("/a/very/long/path\n", 8), "/a/very/long/path\n");
  EXPECT_EQ(WrappedText("next: hydroscope fit log.csv\n", 8), "next: hydroscope fit log.csv\n");
  EXPECT_EQ(WrappedText("none; call `hydroscope fit log.csv` now\n", 12),
            "none; call\n    `hydroscope fit log.csv`\n    now\n");
  EXPECT_EQ(WrappedText("a ` stands alone", 8), "a `\n    stands\n    alone");
  EXPECT_EQ(WrappedText("next:    hydroscope fit log.csv\n", 8), "next:    hydroscope fit log.csv\n");
}

}  // namespace
}  // namespace hydroscope
