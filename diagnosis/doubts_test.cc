#include "diagnosis/doubts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "diagnosis/sample_grams.h"
#include "diagnosis/simulated_log_fixture.h"

namespace hydroscope {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Doubts, WhatIsLeftIsNotToldAsALawWhereNoneWouldExplainIt) {
  PressOptions options;
  options.seconds = 20;
  const SimulatedStrokes log = StrokesOfPress(options);
  const StrokeSet strokes(log.model, GramsOf(log.model, log.strokes, log.window), log.window);
  const ExplainOptions thresholds;
  Explanation found = Explain(strokes, thresholds);
  const CandidateModel start = StartModel(strokes, {});
  const EffectRanking ranking(strokes, thresholds, found.base.noise_variance);
  const Doubts doubts(strokes, thresholds, start, ranking);
  found.remainder = 0;
  found.remainder_law = "";
  found.final.excess_ratio = 0.17;
  EXPECT_THAT(doubts.Of(found, false).english, HasSubstr("17 % more energy than sensor noise"));
  found.remainder_law = "drag";
  EXPECT_THAT(doubts.Of(found, false).english, HasSubstr("another law would explain (drag)"));
  EXPECT_THAT(doubts.Of(found, false).english, Not(HasSubstr("()")));
}

}  // namespace
}  // namespace hydroscope
