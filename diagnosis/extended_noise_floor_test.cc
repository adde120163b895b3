#include <gtest/gtest.h>

#include "diagnosis/extended_fit.h"
#include "studies/simulated_strokes.h"

namespace hydroscope {
namespace {

TEST(ExtendedFit, HasTheNoiseFloorOfTheBaseFitWhereNoEffectIsAdded) {
  PressOptions press;
  press.seconds = 30;
  const auto log = StrokesOf(SimulatePress(press), MachineFor(press));
  ASSERT_TRUE(log) << log.error().text;
  const std::vector<StrokeGram> grams = log->Grams();
  const auto base = FitBaseModel(*log->model, grams, log->window);
  ASSERT_TRUE(base) << base.error().text;
  const ExtendedFit extended = StrokeSet(log->model, grams, log->window).Fit({});
  EXPECT_NEAR(extended.noise_floor, base->noise_floor, 1e-9 * base->noise_floor);
  EXPECT_GT(extended.noise_floor, 0);
}

}  // namespace
}  // namespace hydroscope
