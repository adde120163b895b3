#include "core/text_encoding.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

TEST(TextEncoding, LeavesUtf8AsItIs) {
  EXPECT_EQ(ToUtf8("Öltemp [°C]"), "Öltemp [°C]");
  EXPECT_EQ(ToUtf8(""), "");
  EXPECT_TRUE(IsUtf8("µm"));
}

TEST(TextEncoding, ReadsWhatIsNoUtf8AsLatin1) {
  EXPECT_FALSE(IsUtf8("\xd6ltemp"));
  EXPECT_EQ(ToUtf8("\xd6ltemp [\xb0"
                   "C]"),
            "Öltemp [°C]");
  EXPECT_EQ(ToUtf8("Fl\xe4"
                   "che m\xb2"),
            "Fläche m²");
}

}  // namespace
}  // namespace hydroscope
