#include "diagnosis/testability.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "estimation/analytic_stroke_fixture.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;

/// Untestable effects of strokes whose oil warms by `warming` K from the first to the last.
std::map<std::string, Told> UntestableAt(double warming) {
  ModelStructure model = **BuildModel(AnalyticMachine());
  AddSampleEffects(model);
  std::vector<StrokeStretches> strokes;
  for (int k = 0; k < 5; ++k) {
    AnalyticStroke stroke(0.2);
    Stretch s = SampleStroke(model, stroke, 200, 0.002);
    std::fill(s.channel[kOilTemperature].begin(), s.channel[kOilTemperature].end(),
              313.15 + warming * k / 4.0);
    strokes.push_back({std::move(s)});
  }
  std::map<std::string, Told> untestable;
  AddUntestable(model, strokes, untestable);
  return untestable;
}

TEST(Testability, LawsOfTheOilTemperatureNeedOilThatWarms) {
  const auto cold = UntestableAt(1.0);
  ASSERT_EQ(cold.size(), 6u);
  EXPECT_THAT(cold.at("oil_viscosity").english, HasSubstr("the oil changed by 1.0 K, it needs 2.0 K"));
  EXPECT_THAT(cold.at("pressure_gain_temperature").english, HasSubstr("it needs 2.0 K"));
  EXPECT_THAT(cold.at("spool_null_temperature").english, HasSubstr("it needs 2.0 K"));
  EXPECT_THAT(cold.at("leakage_temperature").english, HasSubstr("it needs 3.0 K"));
  EXPECT_EQ(UntestableAt(2.5).size(), 1u);
  EXPECT_TRUE(UntestableAt(10).empty());
}

}  // namespace
}  // namespace hydroscope
