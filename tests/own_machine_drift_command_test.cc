#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/command_line_fixture.h"

namespace hydroscope::command_line_test {
namespace {

using testing::HasSubstr;

constexpr char kSeal[] = R"toml([machine]
name = "seal"
model = "expressions"
[log]
time = { column = "t", unit = "s" }
[signals]
F = { column = "force", unit = "N" }
x = { column = "pos", unit = "mm" }
p = { column = "p", unit = "bar" }
T_oil = { column = "oil", unit = "degC" }
[balance]
output = "F"
unit = "N"
terms = { A = "p", b = "ddt(x)", c = "1" }
[gate]
conditions = { "ddt(x)" = { min = 0.01, unit = "m/s" } }
)toml";

/// A rod in a seal whose viscous friction follows the oil, which warms and cools by 5 K, and is a quarter more after stroke 200.
class OwnMachineDrift : public CommandLine {
 protected:
  static constexpr int kStrokes = 320, kChange = 200;

  std::string Log(double more) {
    std::string text = "t,force,pos,p,oil\n";
    std::mt19937 random(6);
    std::normal_distribution<double> normal;
    const double turn = 2 * std::numbers::pi, period = 4, step = 0.005;
    for (int row = 0; row < kStrokes * period / step; ++row) {
      const double t = row * step, w = turn / period;
      const double oil = 42 + 5 * std::sin(turn * t / 210), pressure = 3e5 + 1e5 * std::sin(turn * 0.37 * t);
      const double viscous = 800 * std::exp(-0.03 * (oil - 40)) * (t > kChange * period ? 1 + more : 1);
      const double force = 5e-4 * pressure + viscous * 0.1 * w * std::cos(w * t) + 20 + 0.5 * normal(random);
      text += fmt::format("{:.3f},{:.3f},{:.5f},{:.5f},{:.2f}\n", t, force,
                          100 * std::sin(w * t) + 0.002 * normal(random),
                          pressure / 1e5 + 1e-3 * normal(random), oil + 0.05 * normal(random));
    }
    WriteText(File("seal.csv"), text);
    return File("seal.csv");
  }
  /// What `replay` says under these rules.
  std::string Replayed(double more, const std::string& watched) {
    WriteText(File("seal.toml"), kSeal);
    WriteText(File("seal_rules.toml"), "[monitor]\ncommissioning = 120\n[watch]\n" + watched);
    const Ran replayed = Run({"replay", Log(more), "-m", File("seal.toml"), "--db", File("seal.db")});
    EXPECT_EQ(replayed.exit_code, 0);
    return replayed.out;
  }
  /// What stands after the log, by rules that name none of the machine's quantities.
  std::string Standing(double more) {
    Replayed(more, "K = { change = 0.05 }\n");
    return Run({"alarms", "--db", File("seal.db"), "list"}).out;
  }
};

TEST_F(OwnMachineDrift, IsSeenThoughTheRulesKnowNothingOfTheMachine) {
  EXPECT_THAT(Standing(0.25), HasSubstr("unnamed_change_b"));
}

TEST_F(OwnMachineDrift, ARulesFileThatDoesNotFitIsToldAbout) {
  const std::string said = Replayed(0, "A = { change = 0.05 }\nbb = { change = 0.05 }\n");
  EXPECT_THAT(
      said, HasSubstr("watches bb, which this machine has not: did you mean \"b\"? parameters are A, b, c"));
  EXPECT_THAT(said, HasSubstr("leaves b, c unwatched"));
}

TEST_F(OwnMachineDrift, IsNotSeenInWhatFollowsTheOil) {
  EXPECT_THAT(Standing(0), HasSubstr("no alarm stands"));
}

}  // namespace
}  // namespace hydroscope::command_line_test
