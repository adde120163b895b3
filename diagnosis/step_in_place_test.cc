#include "diagnosis/step_in_place.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "diagnosis/simulated_log_fixture.h"

namespace hydroscope {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

Explanation WithMovingModulus(const ImperfectionSetting& imperfection) {
  PressOptions options = RandomMachine(92);
  options.seconds = 100;
  options.seed = 72;
  options.imperfections = {imperfection};
  const SimulatedStrokes log = StrokesOfPress(options);
  return ExplainSamples(log.model, log.strokes, log.window, {});
}

TEST(StepInPlace, ADriftThatIsOneStepIsInDoubt) {
  const Explanation x = WithMovingModulus({"K_step", -0.1, {{"until", 0.5}}, ""});
  EXPECT_THAT(x.set, Contains("K_drift"));
  EXPECT_TRUE(x.partial);
  EXPECT_THAT(x.doubt.english, HasSubstr("one step of K at 5"));
}

TEST(StepInPlace, ADriftIsNone) {
  const Explanation x = WithMovingModulus({"K_drift", -0.2, {}, ""});
  EXPECT_THAT(x.set, Contains("K_drift"));
  EXPECT_THAT(x.doubt.english, Not(HasSubstr("one step")));
}

}  // namespace
}  // namespace hydroscope
