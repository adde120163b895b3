#include "workbench/identifiability.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hydroscope {
namespace {

using testing::HasSubstr;

Estimate Known(double value, double std, const std::string& unit = "Pa") {
  Estimate e;
  e.parameter = std::string("K");
  e.value = value;
  e.std = std;
  e.unit = unit;
  e.reason = EstimateReason::kUpdated;
  return e;
}
const Condition kSpeed{
    .name = "speed", .title = {"mean speed"}, .signal = "z", .unit = "m/s", .vary = {"ram speed"}};

Driving Varied(int strokes) { return {strokes, 0, {{kSpeed, 0.02, 0.12}}, 310, 315}; }

CheckedParameter Judge(const Estimate& estimate, const Driving& driving) {
  return JudgeParameters({&estimate, 1}, driving).front();
}

TEST(Identifiability, ANarrowIntervalIsGoodAndNeedsNoAdvice) {
  const CheckedParameter p = Judge(Known(1.2e9, 0.02e9), Varied(20));
  EXPECT_EQ(p.verdict, Identifiability::kGood);
  EXPECT_EQ(p.advice.english, "");
}

TEST(Identifiability, AWideIntervalAsksForAsManyStrokesAsHalveIt) {
  const CheckedParameter p = Judge(Known(1.0e9, 0.2e9 / 1.96), Varied(20));  // 20 %, twice the goal
  EXPECT_EQ(p.verdict, Identifiability::kWeak);
  EXPECT_THAT(p.advice.english, HasSubstr("at least 80 strokes"));
}

TEST(Identifiability, ConstantSpeedAsksForVariedSpeed) {
  Driving constant = Varied(20);
  constant.ranges = {{kSpeed, 0.049, 0.051}};
  Estimate e = Known(1.0e9, 0.9e9);
  e.reason = EstimateReason::kConfounded;
  const CheckedParameter p = Judge(e, constant);
  EXPECT_EQ(p.verdict, Identifiability::kNot);
  EXPECT_THAT(p.advice.english,
              HasSubstr("vary ram speed between strokes: their mean speed was 49 to 51 mm/s"));
}

TEST(Identifiability, DimensionlessParametersAreJudgedByTheirAbsoluteWidth) {
  EXPECT_EQ(Judge(Known(0.0001, 0.004, "1"), Varied(20)).verdict, Identifiability::kGood);
  EXPECT_EQ(Judge(Known(0.0001, 0.02, "1"), Varied(20)).verdict, Identifiability::kWeak);
}

TEST(Identifiability, NumbersWithoutAUnitOfAModelWithStatesAreNoShares) {
  Driving pieces = Varied(20);
  pieces.of_one_log = true;
  EXPECT_EQ(Judge(Known(350, 0.04, "1"), pieces).verdict, Identifiability::kGood);
  EXPECT_EQ(Judge(Known(0.005, 0.0045, "1"), pieces).verdict, Identifiability::kWeak);
}

TEST(Identifiability, OneStrokeGivesNoInterval) {
  const CheckedParameter p = Judge(Known(1e9, 1e6), Varied(1));
  EXPECT_EQ(p.verdict, Identifiability::kNot);
  EXPECT_THAT(p.advice.english, HasSubstr("at least 10 strokes, this log has 1"));
}

TEST(Identifiability, AForbiddenValuePointsAtTheMachineFile) {
  Estimate e = Known(-1e9, 1e6);
  e.reason = EstimateReason::kOutsidePhysics;
  EXPECT_THAT(Judge(e, Varied(20)).advice.english, HasSubstr("signs"));
}

}  // namespace
}  // namespace hydroscope
