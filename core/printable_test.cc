#include "core/printable.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

TEST(Printable, WritesControlCharactersOut) {
  EXPECT_EQ(Printable("p_A\x1b[2J\r\n"), "p_A\\x1b[2J\\x0d\\x0a");
  EXPECT_EQ(Printable("\xc2\x9b"
                      "31m\x7f"),
            "\\x9b31m\\x7f")
      << "the one-character form of ESC [";
}

TEST(Printable, LeavesTextInAnyLanguageAsItIs) { EXPECT_EQ(Printable("Größe 40 °C ±"), "Größe 40 °C ±"); }

}  // namespace
}  // namespace hydroscope
