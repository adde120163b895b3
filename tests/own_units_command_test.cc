// A machine of the user's own is told of in its own quantities and in the units of its file.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::HasSubstr;
using testing::Not;

constexpr char kMotor[] = R"toml(
[machine]
name = "swing drive"
[log]
time = { column = "t", unit = "s" }
[signals]
n = { column = "n", unit = "rpm" }
dp = { column = "dp", unit = "bar" }
M = { column = "M", unit = "Nm" }
P = { column = "P", unit = "kW" }
[gate]
max_stroke = 4
[balance]
output = "M"
terms = { V_g = "dp", c = "-n", M_c = "-sign(n)" }
)toml";

class Motor : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    std::ofstream(File("motor.toml")) << kMotor;
    std::ofstream log(File("motor.csv"));
    log << "t,n,dp,M,P\n";
    for (int k = 0; k < 12'000; ++k) {
      const double t = 2e-3 * k, n = 900 * std::sin(1.9 * t) + 400 * std::sin(4.4 * t + 1),
                   dp = 120 * std::sin(0.8 * t) + 40 * std::sin(3.3 * t + 2), speed = n * 2 * M_PI / 60,
                   noise = 0.2 * std::sin(1.1e4 * t * t);
      const double torque = 1.2 * dp - 0.08 * speed - 2.5 * (n > 0 ? 1 : -1) + noise;
      log << fmt::format("{:.3f},{:.2f},{:.3f},{:.4f},{:.4f}\n", t, n, dp, torque, 1e-3 * torque * speed);
    }
  }
};

TEST_F(Motor, CheckShowsTheUnitsOfTheMachineFile) {
  const Ran ran = Run({"check", File("motor.csv"), "--machine", File("motor.toml")});
  EXPECT_THAT(ran.out, testing::ContainsRegex("n +n +-1[0-9.]+ +1[0-9.]+ +[0-9.e-]+ +rpm")) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr(" kW "));
  EXPECT_THAT(ran.out, HasSubstr(" Nm s"));
  EXPECT_THAT(ran.out, Not(HasSubstr("N m/rad")));
}

TEST_F(Motor, TheBalanceMayBeInNewtonMetresAsPeopleWriteThem) {
  WriteText(File("nm.toml"), std::string(kMotor) + "unit = \"Nm\"\n");
  const Ran ran = Run({"fit", File("motor.csv"), "--machine", File("nm.toml"), "--json", File("nm.json")});
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr(" Nm,"));
}

TEST_F(Motor, CompareSpeaksOfTorqueAndOfNoFreeRunInBar) {
  const Ran ran = Run({"compare", File("motor.csv"), "--machine", File("motor.toml")});
  EXPECT_THAT(ran.out, HasSubstr("M, rms in Nm")) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("Per stroke, Nm\n"));
  EXPECT_THAT(ran.out, Not(HasSubstr("free run")));
}

TEST_F(Motor, AParameterMayBeInUnitsOfTorqueAndOneThatIsNoSiUnitIsNamed) {
  const std::string text = kMotor, term = "c = \"-n\"";
  const auto with = [&](const std::string& unit) {
    std::string changed = text;
    changed.replace(changed.find(term), term.size(), "c = { expression = \"-n\", unit = \"" + unit + "\" }");
    WriteText(File("unit.toml"), changed);
    return Run({"fit", File("motor.csv"), "--machine", File("unit.toml")});
  };
  const Ran torque = with("Nm s");
  EXPECT_EQ(torque.exit_code, 0) << torque.err;
  EXPECT_THAT(torque.out, HasSubstr(" Nm s"));
  EXPECT_THAT(with("kW").err, HasSubstr("the SI unit \"W\""));
}

TEST_F(Motor, AnOutputInKilowattsErrsInKilowattsEverywhere) {
  std::string power = kMotor;
  const std::string torque = "output = \"M\"\nterms = { V_g = \"dp\", c = \"-n\", M_c = \"-sign(n)\" }\n";
  power.replace(power.find(torque), torque.size(),
                "output = \"P\"\nterms = { V_g = \"dp*n\", c = \"-n^2\" }\n");
  WriteText(File("power.toml"), power + "[[effect]]\nid = \"windage\"\nterms = { k = \"-abs(n)\" }\n");
  const std::vector<std::string> log = {File("motor.csv"), "--machine", File("power.toml")};
  const auto run = [&](std::vector<std::string> words) {
    words.insert(words.end(), log.begin(), log.end());
    return Run(words);
  };
  for (const char* command : {"fit", "compare", "explain"}) {
    const Ran ran = run({command});
    EXPECT_THAT(ran.out, HasSubstr(" kW")) << command << ran.err;
    EXPECT_THAT(ran.out, Not(testing::ContainsRegex("[0-9] W[ ,;\n]"))) << command;
  }
  EXPECT_THAT(run({"fit"}).out, HasSubstr("the model misses windage;"));
  ASSERT_EQ(run({"model", "add", "windage"}).exit_code, 0);
  EXPECT_THAT(Run({"model", "history", "--machine", File("power.toml")}).out,
              HasSubstr("Error on strokes left out, kW;"));
}

TEST_F(Motor, AFileProposedForItKeepsTheNamesOfItsColumns) {
  const Ran init = Run({"init", File("motor.csv"), "--out", File("proposed.toml"), "--json", "-"});
  EXPECT_EQ(init.exit_code, 0) << init.err;
  const auto proposed = init.Json();
  std::vector<std::string> signals;
  for (const auto& column : proposed.at("columns")) signals.push_back(column.at("signal"));
  EXPECT_THAT(signals, testing::IsSupersetOf<std::string>({"n", "dp", "M"}));
}

TEST_F(Motor, CommandsNameWhatItHasAndWhatTheyAreFor) {
  WriteText(File("windage.toml"),
            std::string(kMotor) + "[[effect]]\nid = \"windage\"\nterms = { k = \"-n*abs(n)\" }\n");
  const std::vector<std::string> machine = {"--machine", File("windage.toml")};
  const auto run = [&](std::vector<std::string> words) {
    words.insert(words.end(), machine.begin(), machine.end());
    return Run(words);
  };
  EXPECT_THAT(run({"model", "effects"}).out, HasSubstr("hydroscope model add windage --machine FILE"));
  const Ran show = run({"model", "show"});
  EXPECT_THAT(show.out, HasSubstr("hydroscope fit LOG"));
  EXPECT_THAT(show.out, Not(HasSubstr("Known\n")));
  EXPECT_THAT(run({"frf", File("motor.csv")}).err, HasSubstr("frf measures a valve"));
  EXPECT_THAT(run({"design", "--range", "n=0:1"}).err,
              HasSubstr("no trajectory is designed for machines of"));
}

TEST_F(Motor, NoFitIsAdvisedOfALogThatTellsNothing) {
  std::ifstream log(File("motor.csv"));
  std::ofstream few(File("few.csv"));
  std::string line;
  for (int row = 0; row < 200 && std::getline(log, line); ++row) few << line << "\n";
  few.close();
  const Ran check = Run({"check", File("few.csv"), "--machine", File("motor.toml")});
  EXPECT_EQ(check.exit_code, 4) << check.err;
  EXPECT_THAT(check.out, Not(HasSubstr("next: hydroscope fit")));
}

TEST_F(Motor, ItsReportSaysNothingOfOilThatItDoesNotHave) {
  ASSERT_EQ(Run({"replay", File("motor.csv"), "-m", File("motor.toml"), "--db", File("motor.db"), "--report",
                 File("motor.html")})
                .exit_code,
            0);
  EXPECT_THAT(ReadText(File("motor.html")), Not(HasSubstr("il temperature")));
}

TEST_F(Motor, NothingUsedAndNothingLeftOutIsNoTable) {
  const Ran ran = Run({"replay", File("missing.csv"), "-m", File("motor.toml"), "--db", File("motor.db")});
  EXPECT_THAT(ran.out, Not(HasSubstr("not used")));
}

TEST_F(Motor, WhatADatabaseDoesNotHoldIsSaid) {
  ASSERT_EQ(Run({"replay", File("motor.csv"), "-m", File("motor.toml"), "--db", File("motor.db")}).exit_code,
            0);
  const Ran verified = Run({"verify-live", "--db", File("motor.db")});
  EXPECT_EQ(verified.exit_code, 4);
  EXPECT_THAT(verified.out, HasSubstr("no run of a service"));
  EXPECT_THAT(Run({"alarms", "--db", File("motor.db"), "journal"}).out,
              HasSubstr("nothing stands in the journal"));
}

}  // namespace
}  // namespace hydroscope
