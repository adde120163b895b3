#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "diagnosis/explain.h"
#include "diagnosis/sample_grams.h"
#include "diagnosis/simulated_log_fixture.h"
#include "estimation/gram_fit.h"

namespace hydroscope {
namespace {

TEST(ExtendedFit, HasTheNoiseFloorOfTheBaseFitWhereNoEffectIsAdded) {
  PressOptions press;
  press.seconds = 30;
  const SimulatedStrokes log = StrokesOfPress(press);
  const auto base = FitBaseModel(*log.model, GramsOf(log.model, log.strokes, log.window), log.window);
  ASSERT_TRUE(base) << base.error().text;
  const ExtendedFit extended = log.Fit();
  EXPECT_NEAR(extended.noise_floor, base->noise_floor, 1e-9 * base->noise_floor);
  EXPECT_GT(extended.noise_floor, 0);
}

/// Noise that is taken for five times as large as it is would hide what is missing.
TEST(Explain, BelievesNoNoiseThatHalfOfTheStrokesDoesNotShow) {
  PressOptions press;
  press.seconds = 60;
  const SimulatedStrokes log = StrokesOfPress(press);
  const auto explained = [&](double noise) {
    std::vector<StrokeGram> grams = GramsOf(log.model, log.strokes, log.window);
    for (StrokeGram& gram : grams)
      for (double& product : gram.noise.packed()) product *= noise;
    return Explain(StrokeSet(log.model, std::move(grams), log.window), {});
  };
  EXPECT_EQ(explained(1).verdict, Verdict::kAdequate);
  const Explanation x = explained(25);
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_THAT(x.doubt.english, testing::HasSubstr("one half of the strokes"));
}

}  // namespace
}  // namespace hydroscope
