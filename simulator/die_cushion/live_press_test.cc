#include "simulator/die_cushion/live_press.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace hydroscope {
namespace {

std::unique_ptr<LivePress> Press(int axes, double work = 0, double pause = 0) {
  LivePress::Options options;
  options.press.sample_period = 1e-3;
  options.press.seconds = 1e6;
  options.axes = axes;
  options.work = work;
  options.pause = pause;
  auto press = LivePress::Create(options);
  EXPECT_TRUE(press) << press.error().text;
  return std::move(*press);
}

/// Runs for at most `seconds` until `done`.
template <typename Done>
bool RunUntil(LivePress& press, double seconds, const Done& done) {
  for (double t = 0; t < seconds; t += press.period()) {
    if (done()) return true;
    press.Next();
  }
  return done();
}

TEST(LivePress, AllCushionsFollowOneRam) {
  auto press = Press(6);
  for (int row = 0; row < 3000; ++row) {
    const auto& rows = press->Next();
    ASSERT_EQ(rows.size(), 6u);
    EXPECT_NEAR(rows[0].z, rows[5].z, 0.002);
  }
  EXPECT_GE(press->strokes(), 1u);
}

TEST(LivePress, IsTheSameAgain) {
  auto one = Press(2), two = Press(2);
  for (int row = 0; row < 500; ++row) {
    const double p = one->Next()[1].p_A;
    ASSERT_EQ(p, two->Next()[1].p_A);
  }
}

TEST(LivePress, AnEffectComesWhileItRunsAndOnlyOnItsAxis) {
  auto press = Press(2);
  auto healthy = Press(2);
  ASSERT_TRUE(press->ChangeEffect({"pressure_offset", 6e5, {}}, 1, 0));
  double moved = 0;
  for (int row = 0; row < 200; ++row) {
    const auto& rows = press->Next();
    const auto& expected = healthy->Next();
    ASSERT_EQ(rows[0].p_A, expected[0].p_A);
    moved = rows[1].p_A - expected[1].p_A;
  }
  EXPECT_GT(std::abs(moved), 1e4);
}

TEST(LivePress, AnEffectCanGrowOverTime) {
  auto press = Press(1), healthy = Press(1);
  ASSERT_TRUE(press->ChangeEffect({"position_signal_delay", 0.1, {}}, -1, 1e3));
  for (int row = 0; row < 100; ++row) {
    const double z = press->Next()[0].z;
    ASSERT_NEAR(z, healthy->Next()[0].z, 1e-3);
  }
  EXPECT_FALSE(press->ChangeEffect({"no_such", 1, {}}, -1, 0));
  EXPECT_FALSE(press->ChangeEffect({"pressure_offset", 1, {}}, 1, 0)) << "there is one axis only";
}

TEST(LivePress, AnEffectTooStiffForTheStepIsRefusedAndChangesNothing) {
  auto press = Press(1), healthy = Press(1);
  const Status status = press->ChangeEffect({"external_leakage", 1e-3, {}}, -1, 0);
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().text, ::testing::HasSubstr("integration step"));
  for (int row = 0; row < 50; ++row) {
    const double p = press->Next()[0].p_A;
    ASSERT_EQ(p, healthy->Next()[0].p_A);
  }
}

TEST(LivePress, AFaultBeginsFromNow) {
  auto press = Press(2);
  for (int row = 0; row < 100; ++row) press->Next();
  ASSERT_TRUE(press->AddFault({.kind = FaultKind::kNan, .channel = "z", .start = 0.05, .duration = 0.01}, 1));
  int missing = 0;
  for (int row = 0; row < 100; ++row) {
    const auto& rows = press->Next();
    EXPECT_FALSE(std::isnan(rows[0].z));
    missing += std::isnan(rows[1].z);
  }
  EXPECT_EQ(missing, 10);
}

TEST(LivePress, PausesAtTheUpperRestAndGoesOn) {
  auto press = Press(1);
  press->SetPause(true);
  ASSERT_TRUE(RunUntil(*press, 20, [&] { return press->resting(); }));
  const std::uint32_t strokes = press->strokes();
  const double z = press->Next()[0].z;
  EXPECT_FALSE(RunUntil(*press, 5, [&] { return press->strokes() != strokes; }));
  EXPECT_NEAR(press->Next()[0].z, z, 0.002);
  press->SetPause(false);
  EXPECT_TRUE(RunUntil(*press, 20, [&] { return press->strokes() > strokes; }));
}

TEST(LivePress, WorksAndPausesInTurn) {
  auto press = Press(1, 3, 2);
  EXPECT_TRUE(RunUntil(*press, 20, [&] { return press->resting(); }));
  EXPECT_TRUE(RunUntil(*press, 3, [&] { return !press->resting(); }));
}

TEST(LivePress, ASweepRunsOnlyAtRest) {
  auto press = Press(2);
  press->Next();
  EXPECT_EQ(press->RequestSweep(0, 0.05), SweepState::kBusy);
  EXPECT_EQ(press->RequestSweep(7, 0.05), SweepState::kRefused);
  press->SetPause(true);
  ASSERT_TRUE(RunUntil(*press, 20, [&] { return press->resting(); }));
  EXPECT_EQ(press->RequestSweep(1, 0.05), SweepState::kGranted);
  double largest = 0, other = 0;
  EXPECT_TRUE(RunUntil(*press, 30, [&] {
    const auto& rows = press->Next();
    largest = std::max(largest, std::abs(rows[1].U_v));
    other = std::max(other, std::abs(rows[0].U_v));
    return press->sweep() == SweepState::kDone;
  }));
  EXPECT_NEAR(largest, 0.5, 0.01) << "V, 5 % of 10 V";
  EXPECT_LT(other, 0.45);
  EXPECT_EQ(press->sweeps_done(), 1u);
}

TEST(LivePress, ASweepIsBrokenOffWhenThePressWorks) {
  auto press = Press(1);
  press->SetPause(true);
  ASSERT_TRUE(RunUntil(*press, 20, [&] { return press->resting(); }));
  press->RequestSweep(0, 0.05);
  press->Next();
  press->SetPause(false);
  EXPECT_EQ(press->sweep(), SweepState::kBroken);
}

}  // namespace
}  // namespace hydroscope
