#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "models/machine_file/format.h"
#include "studies/state_machines.h"
#include "tests/command_line_fixture.h"

namespace hydroscope::command_line_test {
namespace {

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

TEST_F(StateModels, WhatIsMissingIsNoNoiseAndWhatIsLeftWithItIs) {
  const nlohmann::json before =
      Run({"compare", File("log.csv"), "-m", File("machine.toml"), "--json", "-"}).Json();
  EXPECT_TRUE(before["model_error_seen"]);
  EXPECT_EQ(Run({"model", "add", "cubic", File("log.csv"), "-m", File("machine.toml")}).exit_code, 0);
  const nlohmann::json after =
      Run({"compare", File("log.csv"), "-m", File("machine.toml"), "--json", "-"}).Json();
  EXPECT_FALSE(after["model_error_seen"]);
  EXPECT_LT(after["rms_holdout"].get<double>(), 0.3 * before["rms_holdout"].get<double>());
  // An upper bound of the noise before, the noise itself after.
  EXPECT_GT(before["noise_floor"].get<double>(), 0.98 * after["noise_floor"].get<double>());
}

}  // namespace
}  // namespace hydroscope::command_line_test
