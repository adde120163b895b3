#include "cli/help_formatter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
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

/// Help of `path` and of all commands under it.
void ExpectLinesThatFit(const CLI::App& app) {
  std::istringstream lines(app.help());
  for (std::string line; std::getline(lines, line);)
    EXPECT_LE(static_cast<std::ptrdiff_t>(line.size()) -
                  std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xC0) == 0x80; }),
              80)
        << app.get_name() << ": " << line;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    ExpectLinesThatFit(*command);
}

TEST(HelpFormatter, LinesFitTheTerminal) {
  setenv("COLUMNS", "80", 1);
  CLI::App app;
  int exit_code = 0;
  AddCommands(app, exit_code);
  ExpectLinesThatFit(app);
  setenv("COLUMNS", "60", 1);
  EXPECT_THAT(HelpOf("explain"),
              testing::HasSubstr("\n  -d,--db TEXT                Database that 'hydroscope\n"
                                 "                              replay' filled, in place\n"
                                 "                              of a log\n"));
  unsetenv("COLUMNS");
}

TEST(HelpFormatter, EndsWithALineOfItsOwn) { EXPECT_TRUE(HelpOf("frf").ends_with("\n")); }

TEST(FilledFooter, AnExampleGoesOnAsAShellReadsIt) {
  EXPECT_EQ(FilledFooter("  hydroscope alarms --db p.db ack 1 --comment \"seen - and done\"", 40),
            "  hydroscope alarms --db p.db ack 1 \\\n      --comment \"seen - and done\"");
}

TEST(FilledFooter, ProseIsFilledAndExamplesAreNot) {
  EXPECT_EQ(
      FilledFooter(
          "One two\nthree four five.\nExamples:\n  hydroscope fit a.csv b.csv c.csv\n  hydroscope check", 18),
      "One two three four\n    five.\nExamples:\n  hydroscope fit a.csv b.csv c.csv\n  hydroscope check");
}

}  // namespace
}  // namespace hydroscope
