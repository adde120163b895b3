#include <gtest/gtest.h>

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

}  // namespace
}  // namespace hydroscope
