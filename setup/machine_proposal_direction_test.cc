// Which way round signals count is told of a log of strokes alone.

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <random>

#include "setup/press_log_fixture.h"

namespace hydroscope {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kTurned = "turned round";

std::string LogOf(const std::function<std::array<double, 3>(double)>& pressure_position_spool) {
  std::string text = "t,p_A,z,y_v\n";
  for (int row = 0; row < 20000; ++row) {
    const double t = 0.002 * row;
    const auto [p, z, y] = pressure_position_spool(t);
    text += fmt::format("{:.3f},{:.5g},{:.6g},{:.5g}\n", t, p, z, y);
  }
  return text;
}

TEST(MachineProposal, WhatIsNoStrokeTurnsNoSignalRound) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  const auto noise = Propose(LogOf([&](double) -> std::array<double, 3> {
    return {100e5 + 30e5 * normal(random), 0.1 + 0.03 * normal(random), 0.3 * normal(random)};
  }));
  const auto swings = Propose(LogOf([](double t) -> std::array<double, 3> {
    return {100e5 + 60e5 * std::sin(3.1 * t), 0.1 + 0.08 * std::cos(1.7 * t), 0.4 * std::sin(1.9 * t + 1)};
  }));
  for (const MachineProposal& proposal : {noise, swings}) {
    EXPECT_THAT(InEnglish(proposal.decided), Not(Contains(HasSubstr(kTurned))));
    EXPECT_THAT(InEnglish(proposal.open), Contains(HasSubstr("which way round they count cannot be told")));
    for (const SignalSpec& signal : proposal.machine.signals) EXPECT_GT(signal.scale, 0) << signal.name;
    ExpectLoads(proposal);
  }
}

TEST(MachineProposal, AStrokeStillTurnsThemRound) {
  const auto reversed = Propose(PressLog("t,p_A,z,y_v\n", [](const PressRow& row) {
    return fmt::format("{:.3f},{:.5g},{:.6g},{:.5g}", row.t, row.p_A, 0.25 - row.z, -row.y_v);
  }));
  EXPECT_THAT(InEnglish(reversed.decided), Contains(HasSubstr("z rises while the pressure is high: turned")));
  EXPECT_THAT(InEnglish(reversed.decided), Contains(HasSubstr("y_v is negative in the strokes: turned")));
}

TEST(MachineProposal, ATableThatIsNoLogOfAMachineIsSaidToBeNone) {
  std::string text = "id,salary,age\n";
  for (int row = 0; row < 400; ++row)
    text += fmt::format("{},{},{}\n", row, 20000 + row * 7919 % 70000, 20 + row * 13 % 45);
  EXPECT_THAT(InEnglish(Propose(text).decided), Contains(HasSubstr("see whether this is the log of one")));
}

TEST(MachineProposal, AHundredPascalsInTheNameAreNoBar) {
  std::string text = "t,pressure_hPa,flow\n";
  for (int row = 0; row < 2000; ++row)
    text += fmt::format("{:.3f},{:.1f},{:.4f}\n", 0.01 * row, 1013 + 5 * std::sin(0.05 * row),
                        std::cos(0.05 * row));
  const auto proposal = Propose(text);
  const int pressure = proposal.machine.SignalIndex("p_A");
  ASSERT_GE(pressure, 0) << proposal.text;
  EXPECT_EQ(proposal.machine.signals[static_cast<std::size_t>(pressure)].unit, "mbar") << proposal.text;
}

}  // namespace
}  // namespace hydroscope
