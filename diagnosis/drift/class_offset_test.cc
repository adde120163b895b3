#include "diagnosis/drift/class_offset.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/constants.h"

namespace hydroscope::drift {
namespace {

std::vector<ClassDeviation> Strokes(double offset, double std, int count, std::mt19937& random) {
  std::normal_distribution<double> noise(0, std);
  std::vector<ClassDeviation> strokes;
  for (int k = 0; k < count; ++k) strokes.push_back({offset + noise(random), 1 / (std * std)});
  return strokes;
}

TEST(ClassOffset, IsFoundWithinItsStdAndOneWildStrokeHardlyMovesIt) {
  std::mt19937 random(3);
  int inside = 0;
  for (int k = 0; k < 400; ++k) {
    auto strokes = Strokes(2.0, 0.5, 60, random);
    strokes[7].value = 1000;
    const ClassOffset offset = MeasureOffset(strokes);
    inside += std::abs(offset.offset - 2.0) < kNormal95 * offset.std;
  }
  EXPECT_GT(inside, 370);
}

TEST(ClassOffset, SpreadBetweenClassesIsNotUnderstated) {
  std::mt19937 random(5);
  std::normal_distribution<double> between(1.0, 0.3);
  int covered = 0;
  double sum = 0;
  for (int k = 0; k < 200; ++k) {
    std::vector<ClassOffset> classes;
    for (int c = 0; c < 12; ++c) classes.push_back(MeasureOffset(Strokes(between(random), 0.2, 40, random)));
    const OffsetSpread spread = SpreadOf(classes);
    covered += spread.std >= 0.3;
    sum += spread.std;
  }
  EXPECT_GT(covered, 170);        // the upper limit holds in nine cases of ten
  EXPECT_LT(sum / 200, 2 * 0.3);  // and is no wild one
}

TEST(ClassOffset, EqualClassesHaveASpreadOfNoConsequence) {
  std::mt19937 random(7);
  std::vector<ClassOffset> classes;
  for (int c = 0; c < 20; ++c) classes.push_back(MeasureOffset(Strokes(1.0, 0.2, 40, random)));
  EXPECT_LT(SpreadOf(classes).std, 0.05);
}

TEST(ClassOffset, OneClassTellsNothingAboutOthers) {
  const ClassOffset only{1.0, 0.1, 1.0};
  EXPECT_TRUE(std::isinf(SpreadOf({&only, 1}).std));
  EXPECT_EQ(Combine(only, SpreadOf({&only, 1})).offset, 1.0);
}

TEST(ClassOffset, AClassWithoutStrokesTakesThePrior) {
  const OffsetSpread prior{2.0, 0.1, 0.3};
  const ClassOffset unseen = Combine(MeasureOffset({}, 1.5), prior);
  EXPECT_EQ(unseen.offset, 2.0);
  EXPECT_NEAR(unseen.std, std::hypot(0.1, 0.3), 1e-12);
  EXPECT_EQ(unseen.scatter, 1.5);
  const ClassOffset few = Combine({3.0, 0.3, 1.5}, prior);
  EXPECT_GT(few.offset, 2.4);
  EXPECT_LT(few.offset, 2.6);
  EXPECT_LT(few.std, 0.3);
}

}  // namespace
}  // namespace hydroscope::drift
