#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/command_line_fixture.h"

namespace hydroscope::command_line_test {
namespace {

class PumpDrift : public CommandLine {
 protected:
  static constexpr int kChange = 101, kAfter = 18;  // episodes
  static constexpr double kSeconds = 0.38;          // of each: some more revolutions than a ripple is told by

  /// Alarms of the pump whose control chamber leaks more by a share per second from kChange on.
  nlohmann::json Alarms(const std::string& share) {
    const Ran simulated =
        Run({"simulate", "pump", "--out", File("pump.csv"), "--seconds",
             std::to_string(kSeconds * (kChange + kAfter) + 0.1), "--sample-period", "5e-4", "--wear", share,
             "--wear-from", std::to_string(kSeconds * kChange), "--seed", "11"});
    EXPECT_EQ(simulated.exit_code, 0) << simulated.err;
    const std::string machines = std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/";
    std::string machine = ReadText(machines + "pump.toml");
    const std::string section = "[episodes]\n";
    machine.insert(machine.find(section) + section.size(), fmt::format("seconds = {}\n", kSeconds));
    WriteText(File("pump.toml"), machine);
    WriteText(File("pump_rules.toml"), ReadText(machines + "pump_rules.toml"));
    const Ran replayed =
        Run({"replay", File("pump.csv"), "--machine", File("pump.toml"), "--db", File("pump.db")});
    EXPECT_EQ(replayed.exit_code, 0) << replayed.err;
    return Run({"alarms", "--db", File("pump.db"), "list", "--json", "-"}).Json();
  }
};

TEST_F(PumpDrift, NamesLeakageThatGrowsWithinFiftyEpisodesAndNothingElse) {
  const nlohmann::json alarms = Alarms("0.025")["alarms"];
  ASSERT_EQ(alarms.size(), 1) << alarms.dump(1);
  EXPECT_EQ(alarms[0]["alarm"], "leakage_grown");
  EXPECT_GT(alarms[0]["raised_stroke"], kChange);
  EXPECT_LE(alarms[0]["raised_stroke"], kChange + kAfter);
  EXPECT_NEAR(alarms[0]["first_stroke"].get<int>(), kChange, 10);
}

}  // namespace
}  // namespace hydroscope::command_line_test
