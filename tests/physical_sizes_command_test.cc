#include <regex>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::AllOf;
using testing::HasSubstr;

/// A machine file with a wrong unit or size must stop every command that concludes.
class PhysicalSizes : public CommandLine {
 protected:
  std::string MachineWith(const std::string& pattern, const std::string& replacement) {
    const std::string text = ReadText(kMachine);
    const std::string changed = std::regex_replace(text, std::regex(pattern), replacement);
    EXPECT_NE(changed, text) << pattern;
    WriteText(File("wrong.toml"), changed);
    return File("wrong.toml");
  }
  /// Exit code and message of every command that concludes from this log.
  void ExpectRefused(const std::string& log, const std::string& machine,
                     const testing::Matcher<std::string>& message) {
    for (const std::vector<std::string>& command : {std::vector<std::string>{"fit", log},
                                                    {"compare", log},
                                                    {"explain", log},
                                                    {"model", "add", "internal_leakage", log},
                                                    {"replay", log, "--db", File("wrong.db")}}) {
      std::vector<std::string> words = command;
      words.insert(words.end(), {"-m", machine});
      const Ran ran = Run(words);
      EXPECT_EQ(ran.exit_code, 3) << command.front() << ran.out << ran.err;
      EXPECT_THAT(ran.out + ran.err, message) << command.front();
    }
  }
};

TEST_F(PhysicalSizes, AWrongUnitOfThePressureIsToldWithSignalValueRangeAndCure) {
  const std::string log = Simulate("a.csv", 30, 3);
  const std::string bar = MachineWith("p_A( *= *\\{[^}]*)unit = \"Pa\"", "p_A$1unit = \"bar\"");
  ExpectRefused(
      log, bar,
      AllOf(HasSubstr("p_A"), HasSubstr("reaches"), HasSubstr("1000 bar"), HasSubstr("unit = \"Pa\"")));
}

TEST_F(PhysicalSizes, AWrongUnitOfThePositionOrTheSpool) {
  const std::string log = Simulate("a.csv", 30, 3);
  ExpectRefused(log, MachineWith("\nz( *= *\\{[^}]*)unit = \"m\"", "\nz$1unit = \"mm\""),
                AllOf(HasSubstr("signal z"), HasSubstr("unit = \"m\"")));
}

TEST_F(PhysicalSizes, ASpoolInSharesThatIsDeclaredAsPerCent) {
  const std::string log = Simulate("a.csv", 30, 3);
  ExpectRefused(
      log, MachineWith("\ny_v( *= *\\{[^}]*)unit = \"1\"", "\ny_v$1unit = \"%\""),
      AllOf(HasSubstr("signal y_v (column y_v)"), HasSubstr("reaches 0."), HasSubstr("set unit = \"1\"")));
}

/// All pressures ten times too small fit as well as the right ones; only the modulus tells.
TEST_F(PhysicalSizes, AScaleOfAllPressuresIsToldByEveryCommandThatConcludes) {
  const std::string log = Simulate("a.csv", 60, 3);
  const std::string machine =
      MachineWith("(p_[AB0] *= *\\{[^}]*)unit = \"Pa\"", "$1unit = \"Pa\", scale = 0.1");
  const std::string db = File("wrong.db"), page = File("wrong.html");
  const auto said = HasSubstr("check the scales of pressure and position");
  for (const std::vector<std::string>& command : {std::vector<std::string>{"fit", log, "-m", machine},
                                                  {"check", log, "-m", machine},
                                                  {"explain", log, "-m", machine},
                                                  {"compare", log, "-m", machine},
                                                  {"replay", log, "-m", machine, "--db", db},
                                                  {"trends", "--db", db},
                                                  {"explain", "--db", db},
                                                  {"compare", "--db", db}}) {
    const Ran ran = Run(command);
    EXPECT_THAT(std::regex_replace(ran.out, std::regex("\\s+"), " "), said) << command.front() << ran.err;
  }
  ASSERT_EQ(Run({"report", "--db", db, "--out", page}).exit_code, 0);
  EXPECT_THAT(ReadText(page), said);
}

TEST_F(PhysicalSizes, AWrongUnitOfTheTime) {
  const std::string log = Simulate("a.csv", 30, 3);
  WriteText(File("ms.toml"), ReadText(kMachine) + "");
  const std::string text = ReadText(kMachine);
  const std::string changed =
      std::regex_replace(text, std::regex("(time *= *\\{[^}]*unit *= *)\"s\""), "$1\"ms\"");
  ASSERT_NE(changed, text) << text;
  WriteText(File("ms.toml"), changed);
  ExpectRefused(log, File("ms.toml"), AllOf(HasSubstr("m/s"), HasSubstr("unit of time")));
}

TEST_F(PhysicalSizes, AWrongUnitOfTheOilsTemperature) {
  const std::string log = Simulate("a.csv", 30, 3, {"--oil", "104:110"});  // numbers of a thermometer in degF
  ExpectRefused(log, kMachine, AllOf(HasSubstr("T_oil"), HasSubstr("unit = \"degF\"")));
}

TEST_F(PhysicalSizes, HotOilInAColumnThatSaysItsUnitIsAQuestion) {
  const std::string log = Simulate("a.csv", 30, 3, {"--oil", "94:97"});
  const std::string text = ReadText(log);
  WriteText(log, std::regex_replace(text, std::regex("T_oil"), "T_oil [degC]"));
  const std::string machine = MachineWith("column = \"T_oil\"", "column = \"T_oil [degC]\"");
  for (const char* command : {"fit", "compare", "explain"}) {
    const Ran ran = Run({command, log, "-m", machine});
    EXPECT_EQ(ran.exit_code, 0) << command << ran.out << ran.err;
  }
  EXPECT_THAT(Run({"check", log, "-m", machine}).out,
              AllOf(HasSubstr("T_oil"), HasSubstr("unit = \"degF\"")));
}

/// Of machines with states too, whose fit would run for long to no end.
TEST_F(PhysicalSizes, AWrongUnitOfAPumpOrAnAxis) {
  for (const auto& [machine, log, signal] : {std::tuple("pump", "pump", "outlet_pressure"),
                                             {"flexible_axis", "flexible-axis", "pressure_1"},
                                             {"manipulator", "manipulator", "p_11"}}) {
    ASSERT_EQ(Run({"simulate", log, "--out", File("log.csv"), "--quiet"}).exit_code, 0) << log;
    const std::string text = ReadText(std::string(HYDROSCOPE_SOURCE_DIR "/machines/") + machine + ".toml");
    const std::regex pascal("(\n" + std::string(signal) + " *= *\\{[^}]*)unit = \"Pa\"");
    ASSERT_TRUE(std::regex_search(text, pascal)) << machine;
    WriteText(File("wrong.toml"), std::regex_replace(text, pascal, "$1unit = \"bar\""));
    for (const char* command : {"fit", "compare", "explain"}) {
      const Ran ran = Run({command, File("log.csv"), "-m", File("wrong.toml")});
      EXPECT_EQ(ran.exit_code, 3) << command;
      EXPECT_THAT(ran.out + ran.err, AllOf(HasSubstr(signal), HasSubstr("set unit = \"Pa\""))) << command;
    }
  }
}

TEST_F(PhysicalSizes, AnImpossibleAreaOrPressureDrop) {
  const std::string log = Simulate("a.csv", 30, 3);
  ExpectRefused(log, MachineWith("(A_A *= *\\{ *value *= *)[0-9.]+", "$1 1250000"), HasSubstr("piston area"));
  ExpectRefused(log, MachineWith("(dp_nom *= *\\{ *value *= *)[0-9.]+", "$1 3500"), HasSubstr("dp_nom"));
}

TEST_F(PhysicalSizes, CheckStillLooksAtAWrongLogAndSaysSo) {
  const std::string log = Simulate("a.csv", 30, 3);
  const Ran ran =
      Run({"check", log, "-m", MachineWith("p_A( *= *\\{[^}]*)unit = \"Pa\"", "p_A$1unit = \"bar\"")});
  EXPECT_THAT(ran.out, HasSubstr("unit = \"Pa\""));
}

}  // namespace
}  // namespace hydroscope
