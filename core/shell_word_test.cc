#include "core/shell_word.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

TEST(ShellWord, StandsInQuotesWhereAShellWouldCutIt) {
  EXPECT_EQ(ShellWord("logs/press-7_a.csv"), "logs/press-7_a.csv");
  EXPECT_EQ(ShellWord("Spätschicht.csv"), "Spätschicht.csv");
  EXPECT_EQ(ShellWord("Aufzeichnung Presse 7.csv"), "'Aufzeichnung Presse 7.csv'");
  EXPECT_EQ(ShellWord("Anna's log;rm.csv"), R"('Anna'\''s log;rm.csv')");
  EXPECT_EQ(ShellWord(""), "''");
}

}  // namespace
}  // namespace hydroscope
