#include "pipeline/signal_survey.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hydroscope {
namespace {

Machine OneSignal() {
  Machine machine;
  SignalSpec z;
  z.name = z.column = "z";
  z.unit = "m";
  machine.signals = {z};
  machine.gate.bounds = {{"z", true, {}, -0.004}, {"z", false, 0.1, {}}};
  return machine;
}

/// `rows` rows of 2 ms of a position that falls with 50 mm/s from 0.3 m.
SampleBlock Falling(int rows) {
  SampleBlock block;
  block.Resize(1, static_cast<std::size_t>(rows));
  for (int k = 0; k < rows; ++k) {
    block.time[k] = k * 0.002;
    block.signal[0][k] = 0.3 - 0.05 * k * 0.002;
    block.quality[0][k] = quality::kGood;
  }
  return block;
}

TEST(SignalSurvey, CountsFlagsWithTheTimeOfTheFirst) {
  const Machine machine = OneSignal();
  SignalSurvey survey(machine, 0.002);
  SampleBlock block = Falling(1000);
  block.quality[0][10] = quality::kSpike;
  block.signal[0][10] = 1e9;
  block.quality[0][500] = quality::kSpike | quality::kGap;
  survey.Observe(block);
  const SignalRange& range = survey.ranges()[0];
  EXPECT_EQ(range.good, 998);
  EXPECT_EQ(range.flagged[2], 2);
  EXPECT_DOUBLE_EQ(range.first[2], 0.02);
  EXPECT_DOUBLE_EQ(range.first[4], 1.0);
  EXPECT_DOUBLE_EQ(range.max, 0.3) << "the spike is no range";
}

TEST(SignalSurvey, GapsAndStepsBackAreNoJitter) {
  const Machine machine = OneSignal();
  SignalSurvey survey(machine, 0.002);
  SampleBlock block = Falling(1000);
  for (int k = 500; k < 1000; ++k) block.time[k] += 3;
  block.time[800] = block.time[799];
  for (const int row : {500, 801}) block.quality[0][row] = quality::kGap;
  survey.Observe(block);
  const TimeSurvey time = survey.time();
  EXPECT_EQ(time.gaps, 2) << "the lost time, and the step after the stamp that stood still";
  EXPECT_NEAR(time.longest_gap, 3.002, 1e-9);
  EXPECT_EQ(time.not_forward, 1);
  EXPECT_LT(time.jitter, 1e-9);
}

TEST(SignalSurvey, TellsHowOftenTheGateConditionsHold) {
  const Machine machine = OneSignal();
  SignalSurvey survey(machine, 0.002);
  SampleBlock block = Falling(4000);  // 0.3 m to -0.1 m, above 0.1 m for the first half
  for (std::size_t begin = 0; begin < 4000; begin += 250) {
    SampleBlock part = Falling(250);
    std::copy_n(&block.time[begin], 250, part.time.begin());
    std::copy_n(&block.signal[0][begin], 250, part.signal[0].begin());
    survey.Observe(part);
  }
  const auto conditions = survey.conditions();
  ASSERT_EQ(conditions.size(), 2u);
  EXPECT_EQ(conditions[0].condition, "ddt(z) <= -4 mm/s");
  EXPECT_DOUBLE_EQ(conditions[0].share, 1.0);
  EXPECT_DOUBLE_EQ(conditions[0].share_mirrored, 0.0);
  EXPECT_EQ(conditions[1].condition, "z >= 100 mm");
  EXPECT_NEAR(conditions[1].share, 0.5, 0.01);
}

/// A position that falls while a spool that is read the wrong way round is below its limit, as if the gate never opened.
TEST(SignalSurvey, TellsThatConditionsWouldHoldTogetherWithOneSignReversed) {
  Machine machine = OneSignal();
  SignalSpec spool;
  spool.name = spool.column = "y_v";
  spool.unit = "1";
  machine.signals.push_back(spool);
  machine.gate.bounds = {{"z", true, {}, -0.004}, {"y_v", false, 0.04, {}}};
  SignalSurvey survey(machine, 0.002);
  SampleBlock block;
  block.Resize(2, 4000);
  for (int k = 0; k < 4000; ++k) {
    const bool falls = k % 1000 < 500;
    const int along = k % 500;
    block.time[k] = 0.002 * k;
    block.signal[0][k] = 1e-4 * (falls ? 500 - along : along);
    block.signal[1][k] = falls ? -0.3 : 0.3;
  }
  survey.Observe(block);
  const GateSurvey gate = survey.gate();
  EXPECT_LT(gate.share, 0.05);
  ASSERT_EQ(gate.mirrored.size(), 2u);
  for (const auto& [signal, share] : gate.mirrored) EXPECT_GT(share, 0.4) << signal;
}

}  // namespace
}  // namespace hydroscope
