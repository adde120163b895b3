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

TEST(Printable, WritesOutBytesThatAreNoCharacters) {
  EXPECT_EQ(Printable("q\x9b"
                      "2J\xff.csv"),
            "q\\x9b2J\\xff.csv");
  EXPECT_EQ(Printable("\xe2\x82"), "\\xe2\\x82") << "half a character";
}

TEST(Printable, WritesOutWhatTurnsTheDirectionOfWriting) {
  EXPECT_EQ(Printable("p_\u202eA\u2069"), "p_\\xe2\\x80\\xaeA\\xe2\\x81\\xa9");
  EXPECT_EQ(Printable("−8 … 3 ≤ „ü“"), "−8 … 3 ≤ „ü“") << "other characters that begin with the same byte";
}

TEST(Printable, LeavesTextInAnyLanguageAsItIs) { EXPECT_EQ(Printable("Größe 40 °C ±"), "Größe 40 °C ±"); }

}  // namespace
}  // namespace hydroscope
