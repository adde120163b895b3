#include "diagnosis/drift/change_analysis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hydroscope::drift {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Two quantities that strokes hardly tell apart: their scores are correlated by `correlation`.
struct Strokes {
  double correlation = 0.97;
  double offset_doubt = 0.02, outside_doubt = 0;
  std::deque<JudgedStroke> all;

  Eigen::MatrixXd Information() const {
    Eigen::MatrixXd j(2, 2);
    j << 1, correlation, correlation, 1;
    return 100 * j;
  }
  /// `count` strokes of a class that deviate by `shift`, without noise.
  void Add(int count, int operating_class, double first, double second) {
    for (int k = 0; k < count; ++k)
      all.push_back({static_cast<std::int64_t>(all.size()), operating_class,
                     Information() * Eigen::Vector2d(first, second), Information(),
                     Eigen::Vector2d::Constant(offset_doubt), Eigen::Vector2d::Constant(outside_doubt)});
  }
  ChangeExplanation Explain(double curve_doubt = 0) const {
    const std::vector<DriftSize> sizes(2, DriftSize{0.4, 10, false});
    return ExplainChange(all, -1, sizes, Eigen::Vector2d::Constant(curve_doubt));
  }
};

std::vector<int> Names(const ChangeExplanation& e) {
  std::vector<int> names;
  for (const Moved& m : e.moved) names.push_back(m.quantity);
  return names;
}

TEST(ChangeAnalysis, TheQuantityThatMovedIsNamed) {
  Strokes strokes;
  strokes.Add(20, 0, 1.0, 0);
  const ChangeExplanation e = strokes.Explain();
  EXPECT_THAT(Names(e), ElementsAre(0));
  EXPECT_TRUE(e.decided);
  EXPECT_NEAR(e.moved.front().size, 1.0, 1e-9);
}

TEST(ChangeAnalysis, AClassThatHardlyKnowsItsOffsetsDoesNotDecideBetweenRivals) {
  Strokes strokes;
  strokes.offset_doubt = 0.1;  // as well as a single stroke knows them
  strokes.Add(20, 0, 1.0, 0);
  const ChangeExplanation e = strokes.Explain();
  EXPECT_FALSE(e.decided);
  EXPECT_THAT(e.rivals, ElementsAre(1));
}

TEST(ChangeAnalysis, ClassesErrEachForItselfSoThatSeveralDecideWhatOneDoesNot) {
  Strokes strokes;
  strokes.offset_doubt = 0.1;
  for (int c = 0; c < 8; ++c) strokes.Add(20, c, 1.0, 0);
  EXPECT_TRUE(strokes.Explain().decided);
}

TEST(ChangeAnalysis, ACurveThatErrsLeavesTheContrastBetweenQuantities) {
  Strokes strokes;
  strokes.Add(20, 0, 1.0, 0);
  EXPECT_TRUE(strokes.Explain(0.1).decided);
}

TEST(ChangeAnalysis, WhatTheReferenceMayErrByIsNoDrift) {
  Strokes strokes;
  strokes.outside_doubt = 0.5;
  strokes.Add(20, 0, 1.0, 0);
  EXPECT_THAT(strokes.Explain().moved, IsEmpty());
}

TEST(ChangeAnalysis, OneBadStrokeAddsNoSecondCause) {
  Strokes strokes;
  strokes.correlation = 0.3;
  strokes.Add(5, 0, 1.0, 0);
  strokes.Add(1, 0, 1.0, 5.0);           // fifty standard deviations off
  for (JudgedStroke& s : strokes.all) {  // some scatter, so that there is a usual one
    const double sign = s.sequence % 2 == 0 ? 1 : -1;
    s.score += s.information * Eigen::Vector2d(0.1 * sign, 0.05 * sign);
  }
  EXPECT_THAT(Names(strokes.Explain()), ElementsAre(0));
}

TEST(ChangeAnalysis, ASecondCauseMustBeWorthFindingByItself) {
  Strokes strokes;
  strokes.correlation = 0.3;
  strokes.Add(60, 0, 0.8, 0.35);
  EXPECT_THAT(Names(strokes.Explain()), ElementsAre(0));
  strokes.all.clear();
  strokes.Add(60, 0, 0.8, 0.6);
  EXPECT_THAT(Names(strokes.Explain()), ElementsAre(0, 1));
}

}  // namespace
}  // namespace hydroscope::drift
