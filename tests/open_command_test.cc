#include <gmock/gmock.h>

#include <csignal>
#include <thread>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;

class OpenCommand : public CommandLine {};

TEST_F(OpenCommand, SaysAtOnceThatALogIsNotThere) {
  const Ran ran = Run({"open", File("none.csv")});
  EXPECT_EQ(ran.exit_code, 3);
  EXPECT_THAT(ran.err, testing::HasSubstr("none.csv"));
}

TEST_F(OpenCommand, EndsCleanlyWhenItsTerminalIsClosed) {
  const std::string scratch = File("scratch");
  std::filesystem::create_directory(scratch);
  setenv("TMPDIR", scratch.c_str(), 1);
  // Behind nohup it is ignored, by what the tests start as well.
  const auto inherited = std::signal(SIGHUP, SIG_DFL);
  const pid_t program = Start({"open"});
  std::signal(SIGHUP, inherited);
  unsetenv("TMPDIR");
  for (int k = 0; k < 500 && ReadText(File("stdout")).empty(); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  ASSERT_FALSE(std::filesystem::is_empty(scratch)) << ReadText(File("stderr"));
  kill(program, SIGHUP);
  int state = 0;
  waitpid(program, &state, 0);
  EXPECT_TRUE(WIFEXITED(state) && WEXITSTATUS(state) == 0);
  EXPECT_TRUE(std::filesystem::is_empty(scratch));
}

}  // namespace
}  // namespace hydroscope
