#include <gtest/gtest.h>

#include "tests/command_line_fixture.h"

namespace hydroscope::command_line_test {
namespace {

/// Logs of the simulated test cylinder through replay into a database, 5 s each episode, 1 kHz.
class TestCylinderDrift : public CommandLine {
 protected:
  static constexpr int kSeconds = 5, kChange = 104, kAfter = 60;  // s; episodes

  /// Alarms of the cylinder of which one figure falls by a tenth over the last episodes; "": none does.
  nlohmann::json Alarms(const std::string& figure) {
    std::vector<std::string> words = {"simulate",        "test-cylinder",
                                      "--out",           File("c.csv"),
                                      "--seconds",       std::to_string(kSeconds * (kChange + kAfter)),
                                      "--sample-period", "1e-3",
                                      "--seed",          "71"};
    if (!figure.empty()) {
      words.push_back("--drift-" + figure + "=" + std::to_string(-0.1 / (kSeconds * kAfter)));
      words.insert(words.end(), {"--drift-from", std::to_string(kSeconds * kChange)});
    }
    const Ran simulated = Run(words);
    EXPECT_EQ(simulated.exit_code, 0) << simulated.err;
    const std::string machines = std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/";
    std::string machine = ReadText(machines + "test_cylinder.toml");
    machine.replace(machine.find("seconds = 20"), 12, "seconds = " + std::to_string(kSeconds));
    WriteText(File("c.toml"), machine);
    WriteText(File("c_rules.toml"), ReadText(machines + "test_cylinder_rules.toml"));
    const Ran replayed = Run({"replay", File("c.csv"), "--machine", File("c.toml"), "--db", File("c.db")});
    EXPECT_EQ(replayed.exit_code, 0) << replayed.err;
    return Run({"alarms", "--db", File("c.db"), "list", "--json", "-"}).Json()["alarms"];
  }

  /// Told after its change began: the rule of this figure, and that it has left its limits of the machine file; nothing else.
  void ExpectOnly(const nlohmann::json& alarms, const std::string& rule, const std::string& figure) {
    int named = 0;
    for (const nlohmann::json& alarm : alarms) {
      const std::string id = alarm["alarm"];
      EXPECT_TRUE(id == rule || id.starts_with(figure + ".")) << alarm.dump(1);
      EXPECT_GT(alarm["raised_stroke"], kChange);
      named += id == rule;
    }
    EXPECT_EQ(named, 1) << alarms.dump(1);
  }
};

TEST_F(TestCylinderDrift, OfTheValvesGainIsAlarmedAsSuch) {
  ExpectOnly(Alarms("K-sv"), "less_valve_gain", "K_sv");
}

TEST_F(TestCylinderDrift, OfTheDampingIsAlarmedAsSuch) {
  ExpectOnly(Alarms("zeta-h"), "less_damping", "zeta_h");
}

TEST_F(TestCylinderDrift, OfTheNaturalFrequencyIsAlarmedAsSuch) {
  ExpectOnly(Alarms("f-h"), "softer_oil_column", "f_h");
}

TEST_F(TestCylinderDrift, IsNotSeenInAHealthyCylinder) { EXPECT_EQ(Alarms("").size(), 0); }

}  // namespace
}  // namespace hydroscope::command_line_test
