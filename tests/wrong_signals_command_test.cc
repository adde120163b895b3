// A signal that counts the other way round, or by a wrong scale, is told of by every command that concludes where anything in the log
// or the machine file contradicts it, with what to set.

#include <regex>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class WrongSignals : public CommandLine {
 protected:
  /// The example machine file with more keys for a signal and more lines of geometry.
  std::string MachineWith(const std::string& signal, const std::string& more,
                          const std::string& geometry = "") {
    std::string text = ReadText(kMachine);
    if (!signal.empty()) {
      const std::string changed =
          std::regex_replace(text, std::regex("(\n" + signal + " *= *\\{[^}]*)\\}"), "$1, " + more + " }");
      EXPECT_NE(changed, text) << signal;
      text = changed;
    }
    text = std::regex_replace(text, std::regex("\\[geometry\\]\n"), "[geometry]\n" + geometry + "\n");
    WriteText(File("wrong.toml"), text);
    return File("wrong.toml");
  }
  /// What every command says of the log.
  void ExpectSaid(const std::string& machine, const testing::Matcher<std::string>& said, int exit_code = 0) {
    std::filesystem::remove(File("wrong.db"));
    for (const std::vector<std::string>& command : {std::vector<std::string>{"check", log_},
                                                    {"fit", log_},
                                                    {"explain", log_},
                                                    {"replay", log_, "--db", File("wrong.db")}}) {
      std::vector<std::string> words = command;
      words.insert(words.end(), {"-m", machine});
      const Ran ran = Run(words);
      EXPECT_THAT(ran.out + ran.err, said) << command.front();
      if (command.front() != "check") EXPECT_EQ(ran.exit_code, exit_code) << command.front() << ran.err;
    }
  }
  std::string log_;
};

TEST_F(WrongSignals, AReversedCommandIsTold) {
  log_ = Simulate("a.csv", 60, 3);
  ExpectSaid(MachineWith("U_v", "scale = -1"),
             AllOf(HasSubstr("go against each other"), HasSubstr("likely U_v"),
                   HasSubstr("scale = -1 for it in [signals]")));
}

TEST_F(WrongSignals, AFactorOfTwoOnCommandOrSpoolIsTold) {
  log_ = Simulate("a.csv", 60, 3);
  for (const auto& [signal, scale] : {std::pair("U_v", "0.5"), {"U_v", "2"}, {"y_v", "0.5"}, {"y_v", "2"}})
    ExpectSaid(MachineWith(signal, std::string("scale = ") + scale), HasSubstr("move together, but by "));
}

TEST_F(WrongSignals, AReversedSpoolOrPressureIsNamedInPlaceOfTheGate) {
  log_ = Simulate("a.csv", 60, 3);
  const std::string spool = MachineWith("y_v", "scale = -1");
  for (const char* command : {"check", "fit", "explain"})
    EXPECT_THAT(Run({command, log_, "-m", spool}).out + Run({command, log_, "-m", spool}).err,
                HasSubstr("most likely y_v"))
        << command;
  const std::string pressure = MachineWith("p_A", "scale = -1");
  for (const char* command : {"fit", "explain"}) {
    const Ran ran = Run({command, log_, "-m", pressure});
    EXPECT_EQ(ran.exit_code, 3);
    EXPECT_THAT(ran.out + ran.err,
                AllOf(HasSubstr("signal p_A"), HasSubstr("scale = -1"), Not(HasSubstr("gate"))))
        << command;
  }
  EXPECT_THAT(Run({"check", log_, "-m", pressure}).out, HasSubstr("set scale = -1"));
}

TEST_F(WrongSignals, AnOptionalPressureOfWhichNothingIsUsedIsTold) {
  log_ = Simulate("a.csv", 60, 3);
  ExpectSaid(
      MachineWith("p_B", "scale = -1"),
      AllOf(HasSubstr("p_B (column p_B): 100 % of the readings lie outside"), HasSubstr("set scale = -1")));
}

/// It would be part of effects.
TEST_F(WrongSignals, AReversedPressureWithinItsDeclaredRangeStopsEveryCommand) {
  log_ = Simulate("a.csv", 60, 3);
  std::string text = ReadText(MachineWith("p_B", "scale = -1"));
  text = std::regex_replace(text, std::regex("(p_B[^}]*)min = -20e5"), "$1min = -600e5");
  WriteText(File("wrong.toml"), text);
  ExpectSaid(File("wrong.toml"), AllOf(HasSubstr("signal p_B"), HasSubstr("below a vacuum")), 3);
}

/// Models take up any scale; what the data sheets say does not.
TEST_F(WrongSignals, AScaleThatTheModelTakesUpIsToldByWhatTheMachineFileStates) {
  log_ = Simulate("a.csv", 60, 3);
  const std::string flow = "Q_nom = { value = 100, unit = \"l/min\" }",
                    stroke = "stroke = { value = 200, unit = \"mm\" }";
  for (const auto& [signal, scale] :
       {std::pair("p_A", "2"), {"p_A", "0.5"}, {"y_v", "0.5"}, {"z", "0.1"}, {"z", "2"}})
    ExpectSaid(MachineWith(signal, std::string("scale = ") + scale, flow),
               HasSubstr("where Q_nom = 100 l/min in the machine file"));
  ExpectSaid(MachineWith("z", "scale = 10", stroke), HasSubstr("farther than stroke = 0.2 m"), 3);
  ExpectSaid(MachineWith("", "", flow + "\n" + stroke),
             AllOf(Not(HasSubstr("Q_nom")), Not(HasSubstr("farther than"))));
}

}  // namespace
}  // namespace hydroscope
