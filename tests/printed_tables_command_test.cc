// Tables for people: one unit of a parameter everywhere, lines that fit a terminal, headers of older loggers.

#include <algorithm>
#include <sstream>

#include "core/shown_width.h"
#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const char* const kLongName = "Position des Ziehkissens, Mittelwert beider Geber [m]";

class PrintedTables : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    columns_ = "80";
  }
  /// A simulated log under a German header in ISO-8859-1, as an older logger writes it.
  std::string OldLoggersLog() {
    std::ifstream in(Simulate("si.csv", 40, 3));
    std::string line;
    std::getline(in, line);
    std::string text = "Zeit [s];Druck unten [Pa];Druck oben [Pa];Systemdruck [Pa];" +
                       std::string(kLongName) +
                       ";Ventilstellung;Ventilspannung [V];\xd6ltemperatur [\xb0"
                       "C]\n";
    while (std::getline(in, line)) {
      std::replace(line.begin(), line.end(), ',', ';');
      text += line + "\n";
    }
    WriteText(File("old.csv"), text);
    return File("old.csv");
  }
  static std::size_t LongestLine(const std::string& text) {
    std::size_t longest = 0;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
      if (line.find("hydroscope ") == std::string::npos)  // commands stay whole
        longest = std::max(longest, ShownWidth(line));
    return longest;
  }
};

TEST_F(PrintedTables, TheSpoolNullIsInPercentOfItsStrokeEverywhere) {
  const std::string log = Simulate("press.csv", 40, 3);
  for (const char* command : {"fit", "check", "explain"}) {
    const Ran ran = Run({command, log, "-m", kMachine});
    EXPECT_THAT(ran.out, AllOf(HasSubstr("% of stroke"), Not(HasSubstr("+-")))) << command;
    EXPECT_THAT(ran.out, Not(testing::ContainsRegex("[0-9]e[+-]"))) << command;
    EXPECT_THAT(ran.out, testing::ContainsRegex("K .* 1[0-9]{4} ")) << command;
  }
  const Ran replay = Run({"replay", log, "-m", kMachine, "--db", File("press.db")});
  EXPECT_THAT(replay.out, HasSubstr("% of stroke"));
  EXPECT_THAT(Run({"trends", "--db", File("press.db")}).out, HasSubstr("% of stroke"));
}

TEST_F(PrintedTables, WhatChangedBetweenLogsTakesALineEach) {
  const std::string db = File("since.db"), leak = "--effect=internal_leakage=6e-12";
  ASSERT_EQ(
      Run({"replay", Simulate("a.csv", 60, 1), Simulate("b.csv", 60, 2, {leak}), "-m", kMachine, "--db", db})
          .exit_code,
      0);
  const Ran ran = Run({"explain", "--db", db, "--since", "run:2"});
  EXPECT_THAT(ran.out, testing::ContainsRegex(
                           "\n  K +1[0-9]{4} ± [0-9]+ -> +1[0-9]{4} ± [0-9]+ bar  [+-][0-9.]+ %\n"));
  EXPECT_THAT(ran.out, testing::ContainsRegex("\n  y_0 .* % of stroke"));
  EXPECT_THAT(ran.out,
              testing::ContainsRegex("before, with the model that explains them .* sensor noise alone 0"));
}

TEST_F(PrintedTables, AnOldLoggersHeaderIsReadAndLongNamesBreakNoRow) {
  const std::string log = OldLoggersLog();
  const Ran init = Run({"init", log, "--area", "125", "--out", File("old.toml")});
  EXPECT_EQ(init.exit_code, 0) << init.err;
  EXPECT_THAT(init.out, AllOf(HasSubstr("T_oil      Öltemperatur [°C]"), HasSubstr("p_B        Druck oben"),
                              HasSubstr("with the rod above")));
  EXPECT_LE(LongestLine(init.out), kLineWidth);
  const Ran check = Run({"check", log, "-m", File("old.toml")});
  EXPECT_THAT(check.out,
              AllOf(HasSubstr("Öltemperatur [°C]"), HasSubstr("    column: " + std::string(kLongName)),
                    Not(HasSubstr("\n    none"))));
  EXPECT_LE(LongestLine(check.out), kLineWidth);
}

TEST_F(PrintedTables, EpisodesAndTheErrorsOfSeveralOutputsAreCalledSoOfLogsAndDatabase) {
  const std::string machine = std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/flexible_axis.toml";
  columns_ = "1000";
  ASSERT_EQ(Run({"simulate", "flexible-axis", "--out", File("axis.csv")}).exit_code, 0);
  const Ran replay = Run({"replay", File("axis.csv"), "-m", machine, "--db", File("axis.db")});
  EXPECT_THAT(replay.out,
              AllOf(HasSubstr("% of the outputs' variation"), HasSubstr("(1 episode of \"flexible_axis\")")));
  for (const char* command : {"explain", "compare"}) {
    const std::string said = Run({command, "--db", File("axis.db")}).err;
    EXPECT_THAT(said, AllOf(HasSubstr("1 episode in the chosen part"), Not(HasSubstr("stroke")))) << command;
  }
  EXPECT_THAT(Run({"learn", "--db", File("axis.db"), "-m", machine}).err,
              HasSubstr("commissioning has 1 episode, expected"));
}

TEST_F(PrintedTables, TheEdgesOfAValveAreInOneUnitEverywhere) {
  const std::string machine = std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/manipulator.toml";
  columns_ = "1000";
  ASSERT_EQ(Run({"simulate", "manipulator", "--out", File("arm.csv"), "--seconds", "20"}).exit_code, 0);
  const Ran replay = Run({"replay", File("arm.csv"), "-m", machine, "--db", File("arm.db")});
  EXPECT_THAT(replay.out, AllOf(HasSubstr("l/min per sqrt(bar)"), Not(HasSubstr("m3/(s sqrt(Pa))"))));
  const Ran trends = Run({"trends", "--db", File("arm.db")});
  EXPECT_THAT(trends.out, AllOf(HasSubstr("l/min per sqrt(bar)"), Not(HasSubstr("m3/(s sqrt(Pa))"))));
}

TEST_F(PrintedTables, RowsOfAFrequencyResponseFitALine) {
  ASSERT_EQ(Run({"simulate", "valve", "--out", File("sweep.csv")}).exit_code, 0);
  const Ran frf =
      Run({"frf", File("sweep.csv"), "-m", std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/valve_sweep.toml",
           "--from", "20", "--to", "120"});
  EXPECT_LE(LongestLine(frf.out), kLineWidth);
  EXPECT_THAT(frf.out,
              AllOf(HasSubstr("left out: outside the range"), testing::ContainsRegex(" 0\\.00 +19\n")));
}

TEST_F(PrintedTables, WhatReadsADatabaseTakesTheNameOfAMachineByOneOption) {
  const std::string log = Simulate("named.csv", 40, 3), db = File("named.db");
  ASSERT_EQ(Run({"replay", log, "-m", kMachine, "--db", db}).exit_code, 0);
  EXPECT_EQ(Run({"trends", "--db", db, "--machine-name", "die_cushion"}).exit_code, 0);
  EXPECT_EQ(
      Run({"report", "--db", db, "--machine-name", "die_cushion", "--out", File("named.html")}).exit_code, 0);
  const Ran alarms = Run({"alarms", "--db", db, "--machine-name", "die_cushion"});
  EXPECT_EQ(alarms.exit_code, 0) << alarms.err;
  EXPECT_THAT(alarms.out, HasSubstr("no alarm stands"));
  EXPECT_THAT(alarms.out, HasSubstr("not judged yet, the healthy machine is being learned: die_cushion"))
      << "40 s are no commissioning";
  EXPECT_THAT(alarms.out, testing::ContainsRegex("[0-9]+[[:space:]]+of[[:space:]]+1500[[:space:]]+strokes"));
}

TEST_F(PrintedTables, ErrorsFitALineAndKeepCommandsAndMarksWhole) {
  const Ran none = Run({"trends", "--db", File("no.db")});
  EXPECT_LE(LongestLine(none.err), kLineWidth);
  EXPECT_THAT(none.err, HasSubstr("`hydroscope replay LOG --machine M.toml --db " + File("no.db") + "`"));
  EXPECT_LE(LongestLine(Run({"status", "--db", File("no.db")}).err), kLineWidth);
}

TEST_F(PrintedTables, AnUnknownStudyOrVerbNamesTheNearestOne) {
  EXPECT_THAT(Run({"benchmark", "covrage"}).err,
              HasSubstr("unknown benchmark command 'covrage'; did you mean 'coverage'?"));
  EXPECT_THAT(Run({"alarms", "--db", "list.db", "lst"}).err,
              HasSubstr("unknown alarms command 'lst'; did you mean 'list'?"));
  EXPECT_THAT(Run({"fti", "x.csv"}).err, HasSubstr("unknown command 'fti'; did you mean 'fit'?"));
  EXPECT_THAT(Run({"simulate", "pump", "--out", File("p.csv"), "--effect", "weak_sprign"}).err,
              HasSubstr("'weak_spring'?"));
}

}  // namespace
}  // namespace hydroscope
