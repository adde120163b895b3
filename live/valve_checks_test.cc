#include "live/valve_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulator/valve/valve_sweep.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;
using testing::Not;

Machine ValveMachine() {
  Machine machine;
  machine.name = "press";
  for (const char* name : {"U_v", "y_v", "p_0", "T_oil"}) {
    machine.signals.emplace_back();
    machine.signals.back().name = name;
  }
  machine.live = LiveSpec{};
  return machine;
}

SampleBlock Sweep() {
  const ValveSweepLog log = SimulateValveSweep({});
  SampleBlock rows;
  rows.Resize(4, log.t.size());
  rows.time = log.t;
  rows.signal[0] = log.U_v;
  rows.signal[1] = log.y_v;
  std::fill(rows.signal[2].begin(), rows.signal[2].end(), 210e5);
  std::fill(rows.signal[3].begin(), rows.signal[3].end(), 313.15);
  return rows;
}

TEST(JudgeSweep, ASweepThatRanGivesTheValvesFiguresWithTheConditions) {
  const ValveCheckRecord record = JudgeSweep(Sweep(), ValveMachine(), SweepStatus::kDone, 1.7e9, 0.1);
  EXPECT_EQ(record.outcome, "measured") << record.detail;
  EXPECT_NEAR(record.check.natural_frequency.value, 184, 4 * record.check.natural_frequency.std + 2);
  EXPECT_NEAR(record.check.damping.value, 0.67, 4 * record.check.damping.std + 0.02);
  EXPECT_EQ(record.check.time, 1.7e9);
  EXPECT_NEAR(record.check.supply_pressure, 210e5, 1);
  EXPECT_NEAR(record.check.oil_temperature, 313.15, 1e-6);
}

TEST(JudgeSweep, ARefusedOrBrokenSweepSaysNothingAboutTheValve) {
  for (const auto& [end, outcome] :
       std::vector<std::pair<SweepStatus, std::string>>{{SweepStatus::kBusy, "refused"},
                                                        {SweepStatus::kRefused, "refused"},
                                                        {SweepStatus::kBroken, "broken"},
                                                        {SweepStatus::kUndecided, "no_answer"}}) {
    const ValveCheckRecord record = JudgeSweep(Sweep(), ValveMachine(), end, 0, 0.1);
    EXPECT_EQ(record.outcome, outcome);
    EXPECT_TRUE(std::isnan(record.check.natural_frequency.value));
    EXPECT_FALSE(record.detail.empty());
  }
}

TEST(JudgeSweep, ASweepWithoutExcitationIsUnusableAndNotABadValve) {
  SampleBlock rows = Sweep();
  std::fill(rows.signal[0].begin(), rows.signal[0].end(), 0.0);
  const ValveCheckRecord record = JudgeSweep(rows, ValveMachine(), SweepStatus::kDone, 0, 0.1);
  EXPECT_EQ(record.outcome, "unusable");
  EXPECT_THAT(record.detail, HasSubstr("tells nothing"));
}

TEST(JudgeSweep, APositionThatIsPercentWhereTheMachineFileSaysShareIsNoMeasuredValve) {
  Machine machine = ValveMachine();
  machine.signals[1].unit = "1";
  EXPECT_EQ(JudgeSweep(Sweep(), machine, SweepStatus::kDone, 0, 0.1).outcome, "measured");
  SampleBlock rows = Sweep();
  for (double& y : rows.signal[1]) y *= 100;
  const ValveCheckRecord record = JudgeSweep(rows, machine, SweepStatus::kDone, 0, 0.1);
  EXPECT_EQ(record.outcome, "unusable");
  EXPECT_THAT(record.detail, HasSubstr("full command would move the spool"));
}

TEST(JudgeSweep, ADeadBandIsToldBesideTheFiguresThatItBends) {
  EXPECT_THAT(JudgeSweep(Sweep(), ValveMachine(), SweepStatus::kDone, 0, 0.1).detail,
              Not(HasSubstr("harmonics")));
  SampleBlock rows = Sweep();
  const double band = 0.2 * *std::ranges::max_element(rows.signal[1]);
  for (double& y : rows.signal[1]) y = std::copysign(std::max(0.0, std::abs(y) - band), y);
  const ValveCheckRecord record = JudgeSweep(rows, ValveMachine(), SweepStatus::kDone, 0, 0.1);
  EXPECT_EQ(record.outcome, "measured") << record.detail;
  EXPECT_THAT(record.detail, HasSubstr("harmonics"));
}

}  // namespace
}  // namespace hydroscope
