// A machine of the user's own is told of in its own quantities and in the units of its file.

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

}  // namespace
}  // namespace hydroscope
