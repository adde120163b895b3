#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "setup/machine_proposal.h"
#include "setup/press_log_fixture.h"

namespace hydroscope {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

/// It says nothing of the time between them, and a wrong time makes every flow wrong.
TEST(ProposedTime, ACounterOfRowsIsNoTime) {
  for (const char* name : {"Index", "sample", "Record", "No."}) {
    int count = 0;
    const MachineProposal proposal =
        Propose(PressLog(name + std::string(",p_A,z,y_v\n"), [&](const PressRow& r) {
          return fmt::format("{},{:.0f},{:.6f},{:.6f}", count++, r.p_A, r.z, r.y_v);
        }));
    EXPECT_EQ(proposal.machine.log.time_column, "") << name;
    EXPECT_THAT(InEnglish(proposal.open), Contains(HasSubstr("sample_period"))) << name;
    const auto machine = ParseMachine(proposal.text, "log.toml");
    ASSERT_FALSE(machine) << name;
    EXPECT_THAT(machine.error().text, HasSubstr("sample_period")) << name;
  }
}

TEST(ProposedTime, TakesNanosecondsForWhatTheyAre) {
  const MachineProposal proposal = Propose(PressLog("t,p_A,z,y_v\n", [](const PressRow& r) {
    return fmt::format("{:.0f},{:.0f},{:.6f},{:.6f}", 1e9 * r.t, r.p_A, r.z, r.y_v);
  }));
  EXPECT_EQ(proposal.machine.log.time_unit, "ns");
  ExpectLoads(proposal);
}

TEST(ProposedTime, TakesDayNumbersOfASpreadsheetForDays) {
  const MachineProposal proposal = Propose(PressLog("Zeit,p_A,z,y_v\n", [](const PressRow& r) {
    return fmt::format("{:.11f},{:.0f},{:.6f},{:.6f}", 45123.5 + r.t / 86400, r.p_A, r.z, r.y_v);
  }));
  EXPECT_EQ(proposal.machine.log.time_unit, "d");
  ExpectLoads(proposal);
}

TEST(ProposedTime, TellsHowFarRowsAreApartUnderCoarseTimeStamps) {
  for (const double step : {0.01, 1.0}) {
    const MachineProposal proposal = Propose(PressLog("Time,p_A,z,y_v\n", [&](const PressRow& r) {
      return fmt::format("{:.2f},{:.0f},{:.6f},{:.6f}", std::floor(r.t / step + 1e-6) * step, r.p_A, r.z,
                         r.y_v);
    }));
    EXPECT_EQ(proposal.machine.log.time_unit, "s");
    EXPECT_THAT(InEnglish(proposal.decided), Contains(HasSubstr("rows are 2 ms apart")));
  }
}

TEST(ProposedTime, TellsSlowRowsInSecondsFromFastOnesInMilliseconds) {
  for (const int rate : {5, 1}) {
    std::string text = "t,p_A,z,y_v\n";
    for (int i = 0; i < 600; ++i) {
      const double t = i / static_cast<double>(rate), phase = std::fmod(t, 12.0);
      text += fmt::format("{:.2f},{:.0f},{:.5f},{:.3f}\n", t, phase < 6 ? 180e5 : 20e5,
                          phase < 6 ? 0.2 - 0.02 * phase : 0.08 + 0.02 * (phase - 6), phase < 6 ? 0.3 : -0.3);
    }
    EXPECT_EQ(Propose(text).machine.log.time_unit, "s") << rate;
  }
}

}  // namespace
}  // namespace hydroscope
