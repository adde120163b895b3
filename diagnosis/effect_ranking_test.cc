#include "diagnosis/effect_ranking.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "diagnosis/sample_grams.h"
#include "diagnosis/simulated_log_fixture.h"

namespace hydroscope {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Errs by 70 noise variances more than an exact fit, here more and there less.
ExtendedFit SlightlyWorse(int strokes) {
  ExtendedFit fit;
  fit.excess = Eigen::VectorXd::Constant(strokes, 70.0 / strokes);
  for (int s = 0; s + 1 < strokes; s += 2) {
    fit.excess[s] += 25;
    fit.excess[s + 1] -= 25;
  }
  return fit;
}

TEST(EffectRanking, ExplanationsThatDifferByATrifleOfWhatBothGainAreRivals) {
  PressOptions options;
  options.seconds = 20;
  const SimulatedStrokes log = StrokesOfPress(options);
  const StrokeSet strokes(log.model, GramsOf(log.model, log.strokes, log.window), log.window);
  const ExplainOptions thresholds;
  const EffectRanking ranking(strokes, thresholds, 1.0);
  constexpr int kStrokes = 20;
  ExtendedFit best;
  best.excess = Eigen::VectorXd::Zero(kStrokes);
  EXPECT_TRUE(ranking.IsRival(SlightlyWorse(kStrokes), best, 60000));
  EXPECT_FALSE(ranking.IsRival(SlightlyWorse(kStrokes), best, 500));
}

/// Beside a large leak that the model lacks every size scatters; beside the leak itself these strokes tell the sizes well.
TEST(EffectRanking, WhatCanBeToldBesideWhatWasFoundIsTested) {
  PressOptions options;
  options.seconds = 60;
  options.effects = {{"internal_leakage", 6e-11, {}}};
  const SimulatedStrokes log = StrokesOfPress(options);
  const StrokeSet strokes(log.model, GramsOf(log.model, log.strokes, log.window), log.window);
  const ExplainOptions thresholds;
  const Explanation x = Explain(strokes, thresholds);
  ASSERT_THAT(x.set, ElementsAre("internal_leakage"));
  const EffectRanking ranking(strokes, thresholds, x.base.noise_variance);
  int better = 0;
  for (const RankedEffect& alone : ranking.Rank(StartModel(strokes, {}))) {
    const auto shown = std::ranges::find(x.ranking, alone.id, &RankedEffect::id);
    ASSERT_NE(shown, x.ranking.end()) << alone.id;
    if (!alone.testable && alone.fit.solved)
      EXPECT_THAT(alone.why_not.english, HasSubstr("what the model misses")) << alone.id;
    better += shown->testable && !alone.testable;
    EXPECT_EQ(shown->testable && shown->fit.solved, shown->why_not.empty()) << alone.id;
  }
  EXPECT_GE(better, 3);
}

}  // namespace
}  // namespace hydroscope
