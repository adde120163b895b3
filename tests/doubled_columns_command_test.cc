// Two columns of one name: which is read is said wherever the log is.
#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::HasSubstr;

class DoubledColumns : public CommandLine {
 protected:
  /// A press log whose position comes again as a second p_A.
  std::string Log() {
    std::ifstream from(Simulate("press.csv", 60, 1));
    std::ofstream out(File("twins.csv"));
    bool header = true;
    for (std::string line; std::getline(from, line); header = false)
      out << line << ',' << (header ? "p_A" : line.substr(0, line.find(','))) << '\n';
    return File("twins.csv");
  }
};

TEST_F(DoubledColumns, AreToldByEveryCommandThatReadsTheLog) {
  const std::string log = Log(), twins = "2 columns are called 'p_A' (2, 9): column 2 is read";
  for (const char* command : {"check", "fit", "explain"}) {
    EXPECT_THAT(Run({command, log, "-m", kMachine}).out, HasSubstr(twins)) << command;
    const nlohmann::json json = Run({command, log, "-m", kMachine, "--json", "-"}).Json();
    EXPECT_THAT(json[command == std::string("check") ? "hints" : "notes"].dump(), HasSubstr(twins))
        << command;
  }
  const Ran replay = Run({"replay", log, "-m", kMachine, "--db", File("a.db")});
  EXPECT_THAT(replay.out, HasSubstr(twins));
  const Ran init = Run({"init", log, "--out", File("new.toml")});
  EXPECT_THAT(init.out, HasSubstr(twins + "; where another is meant"));
  EXPECT_THAT(ReadText(File("new.toml")), HasSubstr("called 'p_A'"));
}

TEST_F(DoubledColumns, TwoSignalsOfOneColumnAreAHintOfCheck) {
  const std::string log = Simulate("press.csv", 60, 1);
  std::string machine = ReadText(kMachine);
  const std::string own = "p_B   = { column = \"p_B\"";
  ASSERT_NE(machine.find(own), std::string::npos);
  WriteText(File("m.toml"), machine.replace(machine.find(own), own.size(), "p_B   = { column = \"p_A\""));
  EXPECT_THAT(Run({"check", log, "-m", File("m.toml")}).out, HasSubstr("p_A and p_B both read column 'p_A'"));
}

}  // namespace
}  // namespace hydroscope
