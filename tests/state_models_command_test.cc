#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "models/machine_file/format.h"
#include "report/xml_check_fixture.h"
#include "studies/state_machines.h"
#include "tests/command_line_fixture.h"

namespace hydroscope::command_line_test {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

/// A lightly damped oscillator whose spring hardens, and a machine file that does not know.
class StateModels : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    const StatesLog log = SimulateStates({StateMachineKind::kOscillator, "cubic", 6, 2000});
    std::string text = "t,u,y\n";
    for (std::size_t row = 0; row < log.time.size(); ++row)
      text += fmt::format("{:.9f},{:.9f},{:.9f}\n", log.time[row], log.input[row], log.outputs[0][row]);
    WriteText(File("log.csv"), text);
    WriteText(File("machine.toml"), FormatMachine(StatesMachine(StateMachineKind::kOscillator, "")));
  }
  Ran Of(const std::string& command) { return Run({command, File("log.csv"), "-m", File("machine.toml")}); }
};

TEST_F(StateModels, NobodyIsSentForMoreOfALogThatTheModelDoesNotDescribe) {
  const std::string check = Of("check").out;
  EXPECT_THAT(check, HasSubstr("the model misses something"));
  EXPECT_THAT(check, HasSubstr("next: hydroscope explain"));
  EXPECT_THAT(check, Not(AnyOf(HasSubstr("record "), HasSubstr("noise alone"))));
}

TEST_F(StateModels, WithoutAFitCheckIsDoneInPartAndSendsNobodyToFit) {
  const std::string text = ReadText(File("log.csv"));
  std::size_t end = 0;
  for (int line = 0; line < 8; ++line) end = text.find('\n', end) + 1;
  WriteText(File("log.csv"), text.substr(0, end));
  const Ran ran = Of("check");
  EXPECT_EQ(ran.exit_code, 4);
  EXPECT_THAT(ran.out, AllOf(HasSubstr("no fit: "), Not(HasSubstr("next:"))));
}

/// What rests between noisy phases is stuck for a sensor, and none of an episode's rows is left out for it.
TEST_F(StateModels, AnInputThatRestsIsNoFaultForCheckEither) {
  StatesLog log = SimulateStates({StateMachineKind::kOscillator, "cubic", 6, 2000});
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::string text = "t,u,y\n";
  for (std::size_t row = 0; row < log.time.size(); ++row)
    text += fmt::format("{:.9f},{:.9f},{:.9f}\n", log.time[row],
                        row % 500 < 400 ? log.input[row] + 0.01 * normal(random) : 0.0, log.outputs[0][row]);
  WriteText(File("log.csv"), text);
  const Ran ran = Of("check");
  EXPECT_EQ(ran.exit_code, 0);
  EXPECT_THAT(ran.out, Not(AnyOf(HasSubstr("flagged"), HasSubstr("left out, never"))));
}

TEST_F(StateModels, ThePageOfExplainHoldsVerdictCourseMapAndParameters) {
  const Ran ran =
      Run({"explain", File("log.csv"), "-m", File("machine.toml"), "--report", File("page.html")});
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const std::string page = ReadText(File("page.html"));
  EXPECT_EQ(XmlFault(page), "");
  EXPECT_THAT(page,
              AllOf(HasSubstr("The machine shows what the model lacks: cubic"), HasSubstr("The error falls"),
                    HasSubstr("model as it is, running by itself"), HasSubstr("Where the model errs"),
                    HasSubstr("Every effect, tried alone"), HasSubstr("moved by")));
  const Ran refused =
      Run({"explain", File("log.csv"), "-m", File("machine.toml"), "--report", File("no/such/folder.html")});
  EXPECT_NE(refused.exit_code, 0);
  EXPECT_THAT(refused.err, HasSubstr("there is no such folder"));
}

/// A spring that hardens is missed at large deflections; with it nothing stands out anywhere, and noise alone is left.
TEST_F(StateModels, CompareSaysThatAndWhereTheModelErrs) {
  const auto compared = [&] {
    return Run({"compare", File("log.csv"), "-m", File("machine.toml"), "--json", "-"}).Json();
  };
  const nlohmann::json before = compared();
  EXPECT_TRUE(before["model_error_seen"]);
  ASSERT_FALSE(before["located"].empty());
  EXPECT_EQ(before["located"][0]["output"], "y");
  EXPECT_GT(before["located"][0]["share_error"].get<double>(),
            1.5 * before["located"][0]["share_windows"].get<double>());
  EXPECT_THAT(Of("compare").out, HasSubstr("Where the model errs"));
  EXPECT_EQ(Run({"explain", File("log.csv"), "-m", File("machine.toml"), "--json", "-"}).Json()["located"],
            before["located"]);
  ASSERT_EQ(Run({"model", "add", "cubic", File("log.csv"), "-m", File("machine.toml")}).exit_code, 0);
  const nlohmann::json after = compared();
  EXPECT_FALSE(after["model_error_seen"]);
  EXPECT_LT(after["rms_holdout"].get<double>(), 0.3 * before["rms_holdout"].get<double>());
  // An upper bound of the noise before, the noise itself after.
  EXPECT_GT(before["noise_floor"].get<double>(), 0.98 * after["noise_floor"].get<double>());
  EXPECT_TRUE(after["located"].empty()) << after["located"].dump(1);
  ASSERT_FALSE(after["maps"].empty());
  for (const nlohmann::json& map : after["maps"])
    EXPECT_LE(map["explained"].get<double>(), 1) << map["signals"];
}

/// Which of several units a name has is looked up where the machine file states it.
TEST_F(StateModels, WhereAModelErrsIsToldInTheUnitOfTheOutput) {
  Machine machine = StatesMachine(StateMachineKind::kOscillator, "");
  for (SignalSpec& signal : machine.signals)
    if (signal.name == "y") signal.unit = "mm";
  WriteText(File("machine.toml"), FormatMachine(machine));
  const nlohmann::json compared =
      Run({"compare", File("log.csv"), "-m", File("machine.toml"), "--json", "-"}).Json();
  ASSERT_FALSE(compared["located"].empty());
  EXPECT_EQ(compared["located"][0]["error_unit"], "mm");
  EXPECT_EQ(compared["maps"][0]["error_unit"], "mm");
}

/// A lag under an input that is held from row to row; `push`: on the process, per row at random.
std::string LagLog(double push) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise;
  std::string log = "t,u,y\n";
  double x = 0;
  for (int row = 0; row < 1000; ++row) {
    const double u = std::sin(0.3 * row) + std::sin(0.9 * row);
    log += fmt::format("{:.2f},{:.5f},{:.5f}\n", 0.05 * row, u, x + 1e-3 * noise(random));
    x = 0.8 * x + 0.2 * u + push * noise(random);
  }
  return log;
}

std::string LagMachine(const std::string& hold) {
  return fmt::format(R"toml([machine]
name = "lag"
[log]
hold = "{}"
time = {{ column = "t", unit = "s" }}
[signals]
u = {{ column = "u", unit = "V" }}
y = {{ column = "y", unit = "V" }}
[states]
x = {{ ddt = "k*(u - x)" }}
[outputs]
y = "x"
[parameters]
k = {{ start = 3, min = 0.1, max = 30, unit = "1/s" }}
)toml",
                     hold);
}

TEST_F(CommandLine, InputsThatSeemToMoveInAnotherWayAreToldOf) {
  WriteText(File("lag.csv"), LagLog(0));
  WriteText(File("linear.toml"), LagMachine("linear"));
  WriteText(File("zero.toml"), LagMachine("zero"));
  for (const std::string command : {"fit", "compare", "explain"}) {
    EXPECT_THAT(Run({command, File("lag.csv"), "-m", File("linear.toml")}).out,
                HasSubstr("hold = \"zero\" in [log] leaves 1 % of the error without it, and is taken"))
        << command;
    EXPECT_THAT(Run({command, File("lag.csv"), "-m", File("zero.toml")}).out,
                AllOf(Not(HasSubstr("hold =")), Not(HasSubstr("%/min"))))
        << command;
  }
}

TEST_F(CommandLine, AFreeRunThatHardlyFollowsIsNoModelThatDescribes) {
  WriteText(File("pushed.csv"), LagLog(1));
  WriteText(File("zero.toml"), LagMachine("zero"));
  const auto of = [&](const std::string& command) {
    return Run({command, File("pushed.csv"), "-m", File("zero.toml")}).out;
  };
  EXPECT_THAT(of("fit"), HasSubstr("the free run errs by"));
  EXPECT_THAT(of("compare"), HasSubstr("The model hardly follows what was measured"));
  EXPECT_THAT(of("explain"), HasSubstr("The free run hardly follows what was measured"));
  for (const std::string command : {"check", "fit", "compare", "explain"})
    EXPECT_THAT(of(command), Not(HasSubstr("noise alone"))) << command;
  const nlohmann::json compare =
      Run({"compare", File("pushed.csv"), "-m", File("zero.toml"), "--json", "-"}).Json();
  EXPECT_TRUE(compare["model_error_seen"].is_null());
}

TEST_F(CommandLine, AnErrorWithoutAUnitIsToldAsANumberAlone) {
  std::string machine = LagMachine("zero");
  machine.replace(machine.find("column = \"y\", unit = \"V\""), 24, "column = \"y\", unit = \"1\"");
  WriteText(File("lag.csv"), LagLog(0));
  WriteText(File("one.toml"), machine);
  const std::string fit = Run({"fit", File("lag.csv"), "-m", File("one.toml")}).out;
  EXPECT_THAT(fit, AllOf(HasSubstr("free-run error"), Not(HasSubstr("a number"))));
}

/// The level of the first tank is not measured and begins anywhere: its scale is free, whatever is recorded.
TEST_F(CommandLine, NoRecordIsProposedWhereTheScaleOfAStateIsFree) {
  WriteText(File("free.toml"), R"toml([machine]
name = "tanks"
[log]
hold = "zero"
time = { column = "t", unit = "s" }
[signals]
u = { column = "u", unit = "V" }
level = { column = "y", unit = "V" }
[states]
h_1 = { ddt = "pump*u - k1*h_1" }
h_2 = { ddt = "a*h_1 - k2*h_2" }
[outputs]
level = "h_2"
[parameters]
k1 = { start = 0.1, min = 0.01, max = 2 }
k2 = { start = 0.2, min = 0.01, max = 2 }
a = { start = 0.1, min = 0.01, max = 2 }
pump = { start = 0.1, min = 0.01, max = 2 }
)toml");
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.02);
  std::uniform_int_distribution<int> level(100, 500);
  std::string log = "t,u,y\n";
  double u = 3, first = 4, second = 4;
  for (int row = 0; row < 800; ++row) {
    if (row % 20 == 0) u = level(random) / 100.0;
    log += fmt::format("{},{:.2f},{:.5f}\n", row, u, second + noise(random));
    for (int step = 0; step < 20; ++step) {
      const double in = 0.3 * u - 0.15 * first, out = 0.2 * first - 0.25 * second;
      first += 0.05 * in;
      second += 0.05 * out;
    }
  }
  WriteText(File("free.csv"), log);
  const std::string explained = Run({"explain", File("free.csv"), "-m", File("free.toml")}).out;
  EXPECT_THAT(explained, testing::HasSubstr("No record of these signals shows a, pump"));
  EXPECT_THAT(explained, testing::Not(testing::HasSubstr("What to record, best first")));
}

/// A force in kN that the machine file takes for N: the mass comes out a thousand times too small, and describes the log.
TEST_F(StateModels, ARangeThatReadingsHardlyFillIsToldByEveryCommandThatConcludes) {
  WriteText(File("mass.toml"), R"toml(
[machine]
name = "mass"
model = "states"
[log]
time = { column = "t", unit = "s" }
[signals]
F = { column = "F", unit = "N", min = -3, max = 3 }
x = { column = "x", unit = "m" }
[states]
X = { ddt = "V" }
V = { ddt = "F/m" }
[outputs]
x = "X"
[parameters]
m = { start = 0.001, min = 0.0001, max = 10 }
)toml");
  std::string log = "t,F,x\n";
  std::mt19937 random(1);
  std::normal_distribution<double> noise;
  for (int k = 0; k < 2000; ++k) {
    const double t = 0.01 * k;
    log += fmt::format("{:.2f},{:.6g},{:.6g}\n", t, -1e-3 * (std::sin(t) + std::sin(2.7 * t)),
                       std::sin(t) + std::sin(2.7 * t) / 7.29 + 1e-3 * noise(random));
  }
  WriteText(File("mass.csv"), log);
  for (const auto& words : std::vector<std::vector<std::string>>{
           {"check", File("mass.csv"), "-m", File("mass.toml"), "--json", "-"},
           {"fit", File("mass.csv"), "-m", File("mass.toml"), "--json", "-"},
           {"explain", File("mass.csv"), "-m", File("mass.toml"), "--json", "-"},
           {"replay", File("mass.csv"), "-m", File("mass.toml"), "--db", File("m.db"), "--json", "-"}})
    EXPECT_THAT(Run(words).out, testing::HasSubstr("They look like kN: set unit")) << words[0];
}

}  // namespace
}  // namespace hydroscope::command_line_test
