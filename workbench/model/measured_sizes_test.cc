#include "workbench/model/measured_sizes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "studies/simulated_strokes.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;

Machine Cushion() { return MachineFor(PressOptions{}); }

TEST(MeasuredSizes, AreReadInTheUnitThatExplainShows) {
  const auto measured = MeasuredSizes({"pressure_offset=6.5:0.1", "position_signal_lag=0:0.2"}, Cushion());
  ASSERT_TRUE(measured);
  EXPECT_NEAR(measured->at("pressure_offset").size, 6.5e5, 1);
  EXPECT_NEAR(measured->at("pressure_offset").std, 0.1e5, 1);
  EXPECT_NEAR(measured->at("position_signal_lag").std, 0.2e-3, 1e-9);
}

TEST(MeasuredSizes, SayWhatIsWrongWithThem) {
  const auto error = [](const std::string& text) { return MeasuredSizes({text}, Cushion()).error().text; };
  EXPECT_THAT(error("pressure_offset"), HasSubstr("expected EFFECT=SIZE:STANDARD_ERROR"));
  EXPECT_THAT(error("pressure_ofset=1:1"), HasSubstr("did you mean 'pressure_offset'?"));
  EXPECT_THAT(error("pressure_offset=6.5bar:1"), HasSubstr("expected two numbers in bar"));
  EXPECT_THAT(error("pressure_offset=nan:1"), HasSubstr("expected two numbers in bar"));
  EXPECT_THAT(error("pressure_offset=6.5:inf"), HasSubstr("expected two numbers in bar"));
  EXPECT_THAT(error("pressure_offset=6.5:0"), HasSubstr("the second above 0"));
}

}  // namespace
}  // namespace hydroscope
