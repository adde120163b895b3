#include "cli/help_formatter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

#include "cli/commands.h"

namespace hydroscope {
namespace {

std::string HelpOf(const char* command) {
  const char* words[] = {"hydroscope", command, "--help"};
  testing::internal::CaptureStdout();
  EXPECT_EQ(RunCommandLine(3, words), 0) << command;
  return testing::internal::GetCapturedStdout();
}

TEST(HelpFormatter, LinesFitTheTerminalButCommandsToBeCopiedStayWhole) {
  setenv("COLUMNS", "80", 1);
  for (const char* command :
       {"init", "check", "explain", "open", "frf", "serve", "alarms", "learn", "benchmark"}) {
    std::istringstream lines(HelpOf(command));
    for (std::string line; std::getline(lines, line);)
      EXPECT_TRUE(line.size() <= 80 || line.starts_with("  hydroscope ") || line.find('{') != line.npos)
          << command << ": " << line;
  }
  setenv("COLUMNS", "60", 1);
  EXPECT_THAT(HelpOf("explain"),
              testing::HasSubstr("\n  -d,--db TEXT                Database that 'hydroscope\n"
                                 "                              replay' filled, in place\n"
                                 "                              of a log\n"));
  unsetenv("COLUMNS");
}

TEST(HelpFormatter, EndsWithALineOfItsOwn) { EXPECT_TRUE(HelpOf("frf").ends_with("\n")); }

TEST(FilledFooter, ProseIsFilledAndExamplesAreNot) {
  EXPECT_EQ(
      FilledFooter(
          "One two\nthree four five.\nExamples:\n  hydroscope fit a.csv b.csv c.csv\n  hydroscope check", 18),
      "One two three four\n    five.\nExamples:\n  hydroscope fit a.csv b.csv c.csv\n  hydroscope check");
}

}  // namespace
}  // namespace hydroscope
