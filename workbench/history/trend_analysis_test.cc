#include "workbench/history/trend_analysis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "report/report_fixture.h"
#include "report/report_words.h"
#include "workbench/history/trend_summary.h"

namespace hydroscope {
namespace {

const ParameterAnalysis& Of(const TrendAnalysis& analysis, const std::string& parameter) {
  for (const ParameterAnalysis& p : analysis.parameters)
    if (p.parameter == parameter) return p;
  ADD_FAILURE() << "no parameter " << parameter;
  return analysis.parameters.front();
}

/// Autoregressive noise of unit variance.
std::vector<double> Correlated(std::size_t n, double correlation, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> y = {normal(random)};
  while (y.size() < n)
    y.push_back(correlation * y.back() + std::sqrt(1 - correlation * correlation) * normal(random));
  return y;
}

std::vector<double> Ramp(std::size_t n) {
  std::vector<double> x;
  for (std::size_t i = 0; i < n; ++i) x.push_back(static_cast<double>(i) / static_cast<double>(n) - 0.5);
  return x;
}

class OverCorrelations : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Correlations, OverCorrelations, testing::Values(0.0, 0.5, 0.8, 0.95));

TEST_P(OverCorrelations, IntervalsOfSlopesHoldTheTruthAsOftenAsTheySay) {
  const int seeds = 400;
  int inside = 0;
  const std::vector<double> x = Ramp(120), one(120, 1.0);
  for (int seed = 0; seed < seeds; ++seed) {
    std::vector<double> y = Correlated(120, GetParam(), 1000 + seed);
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += 7 + 3 * x[i];
    const CorrelatedFit fit = FitCorrelated({one, x}, y, {}, GetParam());
    ASSERT_EQ(fit.coefficients.size(), 2u);
    inside += std::abs(fit.coefficients[1].value - 3) < fit.coefficients[1].HalfWidth();
  }
  EXPECT_GT(inside, 0.92 * seeds);
}

TEST_P(OverCorrelations, RarelyFindAChangeWhereThereIsNone) {
  const int seeds = 400;
  int hints = 0, clear = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    const ThirdsComparison change = CompareThirds(Correlated(120, GetParam(), 5000 + seed), {}, GetParam());
    hints += SignificanceOf(change.change) != Significance::kNone;
    clear += SignificanceOf(change.change) == Significance::kClear;
  }
  EXPECT_LT(hints, 0.08 * seeds);
  EXPECT_LT(clear, 0.025 * seeds);
}

TEST_P(OverCorrelations, FindAJumpOfManyStandardDeviations) {
  int clear = 0;
  for (int seed = 0; seed < 50; ++seed) {
    std::vector<double> y = Correlated(120, GetParam(), 9000 + seed);
    for (std::size_t i = 60; i < y.size(); ++i) y[i] += 15;
    clear += SignificanceOf(CompareThirds(y, {}, GetParam()).change) == Significance::kClear;
  }
  EXPECT_GE(clear, 48);
}

/// Courses of a change over 40 values, 0 at first and 1 at last.
double Course(int shape, double x) {
  const double since = std::max(0.0, (x - 0.6) / 0.4);
  switch (shape) {
    case 0:
      return since;
    case 1:
      return since * since;
    case 2:
      return 1 - std::exp(-5 * since);
    case 3:
      return x * x;
    case 4:
      return since > 0 ? 1 : 0;
    default:
      return std::min(1.0, 2 * since);
  }
}

TEST(CompareThirds, FindsALargerChangeNoLessOften) {
  for (int shape = 0; shape < 6; ++shape)
    for (const double size : {200.0, 1000.0}) {
      int clear = 0;
      for (int seed = 0; seed < 20; ++seed) {
        std::vector<double> y = Correlated(40, 0, 100 + seed);
        for (std::size_t i = 0; i < y.size(); ++i) y[i] += size * Course(shape, static_cast<double>(i) / 39);
        clear += SignificanceOf(CompareThirds(y, {}, 0).change) == Significance::kClear;
      }
      EXPECT_EQ(clear, 20) << "shape " << shape << ", size " << size;
    }
}

TEST(FitCorrelated, FindsACorrelationNobodyToldAndWidensItsInterval) {
  const std::vector<double> x = Ramp(300), one(300, 1.0);
  const CorrelatedFit fit = FitCorrelated({one, x}, Correlated(300, 0.8, 3), {}, 0);
  EXPECT_NEAR(fit.correlation, 0.8, 0.12);
  const CorrelatedFit independent = FitCorrelated({one, x}, Correlated(300, 0, 3), {}, 0);
  EXPECT_GT(fit.coefficients[1].HalfWidth(), 2 * independent.coefficients[1].HalfWidth());
}

TEST(FitCorrelated, RefusesTooFewValuesAndColumnsThatAreTheSame) {
  EXPECT_TRUE(FitCorrelated({{1, 1, 1}, {1, 2, 3}}, {1, 2, 3}, {}, 0).coefficients.empty());
  const std::vector<double> one(20, 1.0);
  EXPECT_TRUE(FitCorrelated({one, one}, Ramp(20), {}, 0).coefficients.empty());
}

TEST(CompareThirds, NeverIsSurerThanTheStatedStandardDeviationAllows) {
  const std::vector<double> exact(30, 1.0);
  const ThirdsComparison stated = CompareThirds(exact, std::vector<double>(30, 0.1), 0.9);
  EXPECT_GE(stated.change.std, 0.1);
  EXPECT_FALSE(CompareThirds({1, 2, 3}, {}, 0).change.Known());
}

TEST(AnalyseTrends, FindsTheOilInTheNominalFlowAndNotInStiffnessAndVolume) {
  int follows = 0, covered = 0, false_alarms = 0;
  const int seeds = 100;
  for (int seed = 0; seed < seeds; ++seed) {
    ReportFixture fixture;
    fixture.seed = 100 + seed;
    const TrendAnalysis analysis = AnalyseTrends(fixture.Make());
    const OilDependence& flow = Of(analysis, "Q_vn").oil;
    follows += flow.outcome == OilOutcome::kFollows;
    covered += std::abs(flow.slope.value - 0.006 * ReportFixture::kNominalFlow) < flow.slope.HalfWidth();
    bool alarm = false;
    for (const char* steady : {"K", "V0", "y_0"}) {
      const ParameterAnalysis& parameter = Of(analysis, steady);
      alarm |=
          parameter.oil.outcome == OilOutcome::kFollows || parameter.oil.outcome == OilOutcome::kNotInStep;
      alarm |= parameter.unexplained == Significance::kClear;
    }
    false_alarms += alarm;
    EXPECT_EQ(Of(analysis, "Q_vn").unexplained == Significance::kClear, false) << seed;
  }
  EXPECT_EQ(follows, seeds);
  EXPECT_GE(covered, 0.88 * seeds);
  EXPECT_LE(false_alarms, 0.05 * seeds);
}

TEST(AnalyseTrends, CallsALossOfFlowUnexplainedAlsoWhileTheOilWarms) {
  for (const bool cools : {false, true}) {
    ReportFixture fixture;
    fixture.wear = 0.06;
    fixture.cools_again = cools;
    const TrendAnalysis analysis = AnalyseTrends(fixture.Make());
    EXPECT_EQ(Of(analysis, "Q_vn").unexplained, Significance::kClear) << cools;
    EXPECT_EQ(Of(analysis, "K").unexplained, Significance::kNone) << cools;
    EXPECT_EQ(SignificanceOf(analysis.error.ratio.change), Significance::kClear);
  }
}

/// The plot shows the estimates; a card that says "no change seen" below a plot that falls is not believed.
TEST(AnalyseTrends, DoesNotDenyWhatThePlottedEstimatesShow) {
  ReportFixture fixture;
  fixture.warm = 26.5;
  ReportInput input = fixture.Make();
  for (TrendPoint& point : input.trends)
    if (point.estimate.parameter == "V0")
      point.estimate.value -= 12 * point.estimate.std * static_cast<double>(point.sequence) / 300;
  const TrendAnalysis analysis = AnalyseTrends(input);
  const ParameterAnalysis& volume = Of(analysis, "V0");
  EXPECT_TRUE(volume.by_estimates) << "the blocks show nothing";
  EXPECT_LT(volume.change.change.value, 0);
  EXPECT_EQ(volume.unexplained, Significance::kHint);
  const ParameterInfo info = InfoFor(KindOf(input.machine), "V0", "m3", 1e-3);
  EXPECT_EQ(DescribeParameter(volume, info).standing, Standing::kHint);
  EXPECT_EQ(Of(AnalyseTrends(fixture.Make()), "V0").unexplained, Significance::kNone);
}

TEST(AnalyseTrends, IsTheJudgementThatTrendsTell) {
  ReportFixture fixture;
  fixture.wear = 0.06;
  const ReportInput input = fixture.Make();
  const TrendAnalysis analysis = AnalyseTrends(input);
  for (const TrendSummary& summary : SummariseTrends(input.trends, input)) {
    const ParameterAnalysis& card = Of(analysis, summary.parameter);
    ASSERT_EQ(summary.change.has_value(), card.change.change.Known()) << summary.parameter;
    if (!summary.change) continue;
    EXPECT_EQ(summary.change->value, card.change.change.value) << summary.parameter;
    EXPECT_EQ(summary.change->significant, SignificanceOf(card.change.change) == Significance::kClear);
    EXPECT_EQ(summary.change->hint, SignificanceOf(card.change.change) == Significance::kHint);
  }
}

/// "No change seen" of an interval wider than the parameter, or than the way to its limit, is no all-clear.
TEST(AnalyseTrends, CannotTellWhatItWouldNotSee) {
  ReportFixture fixture;
  ReportInput input = fixture.Make();
  input.blocks.clear();
  const auto judged = [&](const std::string& parameter) {
    const ParameterAnalysis analysis = Of(AnalyseTrends(input), parameter);
    const double value = analysis.latest->value;
    return DescribeParameter(analysis, InfoFor(KindOf(input.machine), parameter, analysis.unit, value));
  };
  EXPECT_EQ(judged("V0").standing, Standing::kSteady);
  for (TrendPoint& point : input.trends)
    if (point.estimate.parameter == "V0") point.estimate.std = 2 * point.estimate.value;
  const ParameterWords blind = judged("V0");
  EXPECT_EQ(blind.standing, Standing::kUnknown);
  EXPECT_EQ(blind.pill, "cannot be told");
  EXPECT_THAT(blind.reading, testing::HasSubstr("would not be seen"));
  EXPECT_EQ(judged("K").standing, Standing::kSteady);
  input.machine.monitors = {
      {"K", 0.999 * ReportFixture::kBulkModulus, std::nullopt, std::nullopt, std::nullopt, std::nullopt}};
  EXPECT_TRUE(Of(AnalyseTrends(input), "K").cannot_tell) << "a change that crosses the limit may be unseen";
  for (const TrendSummary& summary : SummariseTrends(input.trends, input))
    if (summary.parameter == "V0") {
      EXPECT_TRUE(summary.change->cannot_tell);
    }
}

/// Parameters of two models differ though nothing changed.
TEST(AnalyseTrends, ComparesNoEstimatesOfTwoVersionsOfTheModel) {
  ReportFixture fixture;
  ReportInput input = fixture.Make();
  input.blocks.clear();
  for (TrendPoint& point : input.trends)
    if (point.estimate.parameter == "K" && point.sequence >= 150) point.estimate.value *= 1.2;
  ASSERT_NE(SignificanceOf(Of(AnalyseTrends(input), "K").change.change), Significance::kNone);
  input.runs = {RunInfo{.strokes = 150, .first_sequence = 0, .model_version = 1},
                RunInfo{.strokes = 150, .first_sequence = 150, .model_version = 2}};
  const ParameterAnalysis& bulk = Of(AnalyseTrends(input), "K");
  EXPECT_EQ(bulk.version_since, 150);
  EXPECT_EQ(SignificanceOf(bulk.change.change), Significance::kNone);
  input.runs[1].first_sequence = 297;
  input.runs[1].strokes = 3;
  EXPECT_FALSE(Of(AnalyseTrends(input), "K").change.change.Known());
}

TEST(AnalyseTrends, SaysWhenOilAndTimeRanTogether) {
  ReportFixture fixture;
  EXPECT_FALSE(Of(AnalyseTrends(fixture.Make()), "Q_vn").oil.separable);
  fixture.cools_again = true;
  const OilDependence oil = Of(AnalyseTrends(fixture.Make()), "Q_vn").oil;
  EXPECT_TRUE(oil.separable);
  EXPECT_LT(std::abs(oil.beyond.value), oil.beyond.HalfWidth() * 1.5);
}

TEST(AnalyseTrends, AsksNothingOfTheOilWhereItHardlyMovedOrWasNotMeasured) {
  ReportFixture fixture;
  fixture.warm = 26.5;
  EXPECT_EQ(Of(AnalyseTrends(fixture.Make()), "Q_vn").oil.outcome, OilOutcome::kOilHardlyMoved);
  fixture.temperature_measured = false;
  const TrendAnalysis analysis = AnalyseTrends(fixture.Make());
  EXPECT_EQ(Of(analysis, "Q_vn").oil.outcome, OilOutcome::kNotMeasured);
  EXPECT_TRUE(std::isnan(analysis.coldest));
}

TEST(AnalyseTrends, LeavesEstimatesThatWereNotUpdatedOutOfItsStatistics) {
  ReportFixture fixture;
  ReportInput input = fixture.Make();
  for (TrendPoint& point : input.trends)
    if (point.estimate.parameter == "K" && point.sequence % 2 == 0) {
      point.estimate.value *= 3;
      point.estimate.reason = EstimateReason::kNotExcited;
    }
  const TrendAnalysis analysis = AnalyseTrends(input);
  const ParameterAnalysis& k = Of(analysis, "K");
  EXPECT_EQ(k.updated, 150u);
  EXPECT_EQ(k.not_updated.at(EstimateReason::kNotExcited), 150u);
  EXPECT_NEAR(k.change.first, ReportFixture::kBulkModulus, 0.02 * ReportFixture::kBulkModulus);
}

TEST(AnalyseTrends, KnowsWhyAParameterWasNeverIdentified) {
  ReportFixture fixture;
  ReportInput input = fixture.Make();
  for (TrendPoint& point : input.trends)
    if (point.estimate.parameter == "V0") point.estimate.reason = EstimateReason::kConfounded;
  EXPECT_EQ(Of(AnalyseTrends(input), "V0").why_not, EstimateReason::kConfounded);
}

TEST(AnalyseTrends, FindsTheFirstStrokeBeyondALimitAndTheWorseOfTwoLimits) {
  ReportFixture fixture;
  ReportInput input = fixture.Make();
  for (TrendPoint& point : input.trends)
    if (point.estimate.parameter == "K")
      point.estimate.value = point.sequence >= 100 && point.sequence < 110 ? 0.95e9 : 1.3e9;
  const TrendAnalysis analysis = AnalyseTrends(input);
  const LimitCheck& limits = Of(analysis, "K").limits;
  EXPECT_EQ(limits.outcome, LimitOutcome::kAlarmed);
  EXPECT_EQ(limits.strokes, 10);
  EXPECT_EQ(limits.first_sequence, 100);
  EXPECT_DOUBLE_EQ(limits.limit, 1.0e9);
  EXPECT_FALSE(limits.over_now);
  EXPECT_EQ(Of(analysis, "V0").limits.outcome, LimitOutcome::kNone);
}

TEST(AnalyseTrends, SeesAnIntervalThatReachesOverALimit) {
  ReportFixture fixture;
  ReportInput input = fixture.Make();
  input.machine.monitors = {{"K", ReportFixture::kBulkModulus - 0.015e9 * 2, std::nullopt, std::nullopt,
                             std::nullopt, std::nullopt}};
  for (TrendPoint& point : input.trends)
    point.estimate.value = ReportFixture::kBulkModulus, point.estimate.std = 0.02e9;
  EXPECT_EQ(Of(AnalyseTrends(input), "K").limits.outcome, LimitOutcome::kIntervalReaches);
}

TEST(AnalyseTrends, AddsUpTheRunsAndNotThePausesBetweenThem) {
  ReportFixture fixture;
  fixture.runs = 3;
  fixture.strokes_per_run = 2;
  EXPECT_NEAR(AnalyseTrends(fixture.Make()).duration, 3 * (4 + ReportFixture::kStrokeTime), 1e-9);
}

TEST(AdjustForFamily, RaisesEachPByTheQuestionsStillOpen) {
  double a = 0.01, b = 0.04, c = 0.03, d = 0.5;
  AdjustForFamily({&a, &b, &c, &d});
  EXPECT_DOUBLE_EQ(a, 0.04);
  EXPECT_DOUBLE_EQ(c, 0.09);
  EXPECT_DOUBLE_EQ(b, 0.09);  // never below a smaller one
  EXPECT_DOUBLE_EQ(d, 0.5);
}

TEST(FitCorrelated, JointTestFindsCurvatureAsOftenAsItSaysWhereThereIsNone) {
  const std::vector<double> x = Ramp(36), one(36, 1.0);
  std::vector<double> square, cube;
  for (const double v : x) square.push_back(v * v), cube.push_back(v * v * v);
  const int seeds = 600;
  int false_findings = 0, findings = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    std::vector<double> y = Correlated(36, 0, 20000 + seed);
    false_findings += FitCorrelated({one, x, square, cube}, y, {}, 0).JointP(2) < 0.05;
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += 20 * square[i];
    findings += FitCorrelated({one, x, square, cube}, y, {}, 0).JointP(2) < 0.05;
  }
  EXPECT_LT(false_findings, 0.08 * seeds);
  EXPECT_GT(findings, 0.95 * seeds);
}

TEST(StateLatest, AToleranceMakesTheSideOfALimitUncertain) {
  ReportFixture fixture;
  ReportInput input = fixture.Make();
  for (TrendPoint& point : input.trends)
    point.estimate.value = ReportFixture::kBulkModulus, point.estimate.std = 0.001e9;
  const auto limits = [&](double warn_low) {
    input.machine.monitors = {{"K", warn_low, std::nullopt, std::nullopt, std::nullopt, std::nullopt}};
    ParameterAnalysis analysis = Of(AnalyseTrends(input), "K");
    const LimitCheck narrow = analysis.limits;
    StateLatest(10, input.machine, analysis);
    EXPECT_NEAR(analysis.latest->std, 0.01e9, 1);
    return std::pair{narrow, analysis.limits};
  };
  const auto [inside, reaches] = limits(ReportFixture::kBulkModulus - 0.01e9);
  EXPECT_EQ(inside.outcome, LimitOutcome::kWithin);
  EXPECT_EQ(reaches.outcome, LimitOutcome::kIntervalReaches);
  const auto [beyond, unsure] = limits(ReportFixture::kBulkModulus + 0.01e9);
  EXPECT_EQ(beyond.outcome, LimitOutcome::kWarned);
  EXPECT_FALSE(beyond.unsure);
  EXPECT_EQ(unsure.outcome, LimitOutcome::kWarned) << "nor does it take back what was crossed";
  EXPECT_TRUE(unsure.unsure);
}

}  // namespace
}  // namespace hydroscope
