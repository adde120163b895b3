#include "diagnosis/effect_ranking.h"

#include <gtest/gtest.h>

#include "diagnosis/sample_grams.h"
#include "diagnosis/simulated_log_fixture.h"

namespace hydroscope {
namespace {

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

}  // namespace
}  // namespace hydroscope
