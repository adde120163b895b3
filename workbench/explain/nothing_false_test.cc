// Logs that the library holds no law for, or not all signals: neither an all-clear nor a sure name.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "studies/simulated_strokes.h"
#include "workbench/explain/explain_log.h"

namespace hydroscope {
namespace {

using testing::Contains;
using testing::HasSubstr;

PressOptions ASeenPress(std::uint64_t seed) {
  PressOptions options;
  options.seconds = 80;
  options.seed = seed;
  return options;
}

Explanation ExplanationOf(const SimulatedLog& log, const Machine& machine,
                          const ExplainOptions& options = {}) {
  return ExplainStrokes(*StrokesOf(log, machine, KeepSamples::kYes), options)->explanation;
}

/// The magnets of a position sensor err the same at every period of its scale: no function of z that a law could be.
Explanation WithCyclicError(double size, std::uint64_t seed) {
  const PressOptions options = ASeenPress(seed);
  SimulatedLog log = SimulatePress(options);
  for (double& z : log.z) z += size * std::sin(2 * std::numbers::pi * z / 0.011);
  return ExplanationOf(log, MachineFor(options));
}

TEST(NothingFalse, AnErrorThatGoesOnFromBlockToBlockIsNotBlamedOnTheFloor) {
  EXPECT_EQ(WithCyclicError(3e-5, 5).verdict, Verdict::kUnknown);
}

TEST(NothingFalse, AnErrorThatGoesOnFromBlockToBlockIsNoNoiseThoughTheFloorWouldAllowIt) {
  const Explanation x = WithCyclicError(2.2e-5, 6);
  EXPECT_LT(x.base.excess_ratio, ExplainOptions().floor_excess);
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_THAT(x.doubt.english, HasSubstr("goes on from block to block"));
}

/// A rod side without a sensor: its leak to the other chamber and one to the outside are all the same.
TEST(NothingFalse, ALeakIsDoubtedWhereARivalNeedsASignalThatIsMissing) {
  PressOptions options = ASeenPress(3);
  options.effects = {{"internal_leakage", 8e-13, {}}};
  Machine machine = MachineFor(options);
  std::erase_if(machine.signals, [](const SignalSpec& signal) { return signal.name == "p_B"; });
  SimulatedLog log = SimulatePress(options);
  const Explanation x = ExplanationOf(log, machine);
  ASSERT_THAT(x.set, Contains("external_leakage"));
  EXPECT_TRUE(x.partial);
  EXPECT_THAT(x.doubt.english, HasSubstr("internal_leakage"));
  EXPECT_THAT(x.doubt.english, HasSubstr("p_B is not measured"));
}

/// Late by `slow` where the pressure falls and by a quarter of it where it rises, as it moves over some rows.
void LagUnlikeUpAndDown(double slow, SimulatedLog& log) {
  constexpr std::size_t kRows = 5;
  const std::vector<double> p = log.p_A;
  for (std::size_t k = kRows; k + kRows < p.size(); ++k) {
    const double rate = (p[k + kRows] - p[k - kRows]) / (log.t[k + kRows] - log.t[k - kRows]);
    log.p_A[k] -= (rate > 0 ? slow / 4 : slow) * rate;
  }
}

TEST(NothingFalse, ASensorThatLagsUnlikeUpAndDownIsNotTwoEffectsForSure) {
  const PressOptions options = ASeenPress(5);
  SimulatedLog log = SimulatePress(options);
  LagUnlikeUpAndDown(0.0048, log);
  const Explanation x = ExplanationOf(log, MachineFor(options));
  EXPECT_TRUE(x.groups.size() < 2 || x.partial);
  EXPECT_NE(x.verdict, Verdict::kAdequate);
}

/// Weak evidence is let through, so that what noise gains is found at all.
TEST(NothingFalse, NoNameHasAnIntervalThatHoldsZeroWhereNothingIsNeeded) {
  ExplainOptions eager;
  eager.min_gain = 4;
  eager.min_t = 1.2;
  for (const std::uint64_t seed : {41u, 42u, 43u}) {
    const PressOptions options = ASeenPress(seed);
    const Explanation x = ExplanationOf(SimulatePress(options), MachineFor(options), eager);
    for (const EffectEstimate& e : x.final.effects)
      EXPECT_GT(std::abs(e.size), 1.96 * e.std) << seed << " " << x.model->effects[e.choice.effect]->id;
  }
}

TEST(NothingFalse, WhatMayStandOutByChanceIsFlaggedWhereNothingIsNeeded) {
  ExplainOptions eager;
  eager.min_gain = 4;
  eager.min_t = 2.2;
  int named = 0;
  for (const std::uint64_t seed : {41u, 42u, 43u, 44u}) {
    const PressOptions options = ASeenPress(seed);
    const Explanation x = ExplanationOf(SimulatePress(options), MachineFor(options), eager);
    named += !x.set.empty();
    EXPECT_TRUE(x.set.empty() || x.partial) << seed << " " << x.set.front();
  }
  EXPECT_GT(named, 0);
}

}  // namespace
}  // namespace hydroscope
