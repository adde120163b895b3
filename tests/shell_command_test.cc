// What the program says of itself: completion, manual page, --quiet, schema of the JSON.

#include <cstdlib>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::HasSubstr;
using testing::Not;

class Shell : public CommandLine {};

TEST_F(Shell, BashCompletesCommandsAndOptions) {
  const Ran script = Run({"completion", "bash"});
  ASSERT_EQ(script.exit_code, 0) << script.err;
  WriteText(File("complete.sh"), script.out +
                                     "\nCOMP_WORDS=(hydroscope alarms ac); COMP_CWORD=2; _hydroscope; echo "
                                     "${COMPREPLY[0]}\nCOMP_WORDS=(hydroscope fit x --ma); COMP_CWORD=3; "
                                     "_hydroscope; echo ${COMPREPLY[0]}\n");
  ASSERT_EQ(std::system(("bash " + File("complete.sh") + " > " + File("said")).c_str()), 0);
  EXPECT_EQ(ReadText(File("said")), "ack\n--machine\n");
}

TEST_F(Shell, OptionsOfACommandAboveAreCompletedBehindItsVerbsToo) {
  const Ran script = Run({"completion", "bash"});
  WriteText(File("complete.sh"), script.out +
                                     "\nCOMP_WORDS=(hydroscope alarms list --d); COMP_CWORD=3; "
                                     "_hydroscope; echo ${COMPREPLY[0]}\n");
  ASSERT_EQ(std::system(("bash " + File("complete.sh") + " > " + File("said")).c_str()), 0);
  EXPECT_EQ(ReadText(File("said")), "--db\n");
}

TEST_F(Shell, ZshGetsTheSameWords) {
  const Ran script = Run({"completion", "zsh"});
  EXPECT_EQ(script.exit_code, 0);
  EXPECT_THAT(script.out, HasSubstr("#compdef hydroscope"));
  EXPECT_THAT(script.out, HasSubstr("|alarms ack|"));
  EXPECT_THAT(script.out, HasSubstr("  _hydroscope \"$@\"\n"))
      << "the first time it is called as a file of $fpath";
  EXPECT_EQ(Run({"completion", "fish"}).exit_code, 2);
}

TEST_F(Shell, TheManualHasEveryCommandWithItsOptions) {
  const Ran manual = Run({"manual"});
  EXPECT_EQ(manual.exit_code, 0);
  EXPECT_THAT(manual.out, HasSubstr(".TH HYDROSCOPE 1"));
  for (const char* command : {"fit", "explain", "alarms ack", "serve", "report", "completion"})
    EXPECT_THAT(manual.out, HasSubstr(std::string(".SH HYDROSCOPE ") + command)) << command;
  EXPECT_THAT(manual.out, HasSubstr("\\fB\\-\\-machine"));
}

TEST_F(Shell, QuietSaysNothingAndWritesEverything) {
  const std::string log = Simulate("press.csv", 20, 1);
  const Ran ran = Run({"fit", log, "--machine", kMachine, "--json", File("fit.json"), "--quiet"});
  EXPECT_EQ(ran.exit_code, 0);
  EXPECT_EQ(ran.out, "");
  EXPECT_EQ(ran.err, "");
  const auto json = nlohmann::json::parse(ReadText(File("fit.json")));
  EXPECT_EQ(json["schema"], 1);
  EXPECT_TRUE(json["parameters"].contains("K"));
  EXPECT_THAT(Run({"fit", File("no.csv"), "-m", kMachine, "--quiet"}).err, Not(testing::IsEmpty()));
}

TEST_F(Shell, QuietStudiesTellByTheirExitCodeAlone) {
  const std::vector<std::string> study = {"benchmark", "coverage", "--cases", "1", "--seconds", "20"};
  const Ran told = Run(study);
  EXPECT_THAT(told.out, HasSubstr("NOT every"));
  std::vector<std::string> quietly = study;
  quietly.emplace_back("--quiet");
  const Ran ran = Run(quietly);
  EXPECT_EQ(ran.out, "");
  EXPECT_EQ(ran.err, "");
  EXPECT_EQ(ran.exit_code, told.exit_code);
}

}  // namespace
}  // namespace hydroscope
