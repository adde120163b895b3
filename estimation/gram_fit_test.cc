#include "estimation/gram_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "estimation/analytic_stroke_fixture.h"
#include "estimation/stroke_accumulator.h"
#include "simulator/random.h"

namespace hydroscope {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Grams of strokes of white regressors; the output has noise of std `sigma` and each stroke its own offset of theta.
struct Synthetic {
  VectorXd theta = Eigen::Vector3d(2, -1, 0.5);
  std::vector<StrokeGram> strokes;
  MatrixXd regressors;
  VectorXd outputs;

  Synthetic(int count, double sigma) {
    RandomStream random(4);
    constexpr int kEquations = 50;
    regressors.resize(3, count * kEquations);
    outputs.resize(count * kEquations);
    for (int s = 0; s < count; ++s) {
      StrokeGram gram{kEquations + 1,    1, kEquations, SymmetricMatrix(4), SymmetricMatrix(4),
                      SymmetricMatrix(4)};
      for (int e = 0; e < kEquations; ++e) {
        Eigen::Vector4d row;
        for (int i = 0; i < 3; ++i) row[i] = random.Normal();
        row[3] = row.head(3).dot(theta) + sigma * random.Normal();
        for (int i = 0; i < 4; ++i)
          for (int j = i; j < 4; ++j) {
            gram.integral(i, j) += row[i] * row[j];
            gram.flow(i, j) += row[i] * row[j];
          }
        regressors.col(s * kEquations + e) = row.head(3);
        outputs[s * kEquations + e] = row[3];
      }
      strokes.push_back(gram);
    }
  }
};

const std::vector<int> kColumns = {0, 1, 2};

TEST(GramFit, SumsOfGramsAreExactLeastSquaresOverTheirEquations) {
  const Synthetic data(7, 0.3);
  NormalEquations total;
  for (const StrokeGram& gram : data.strokes) total += IntegralEquations(gram, kColumns, 3);
  const VectorXd direct = data.regressors.transpose().colPivHouseholderQr().solve(data.outputs);
  const VectorXd theta = SolveNormalEquations(total);
  ASSERT_EQ(theta.size(), 3);
  EXPECT_LT((theta - direct).norm(), 1e-11);
  EXPECT_EQ(total.equations, 350);
  const double squares = (data.outputs - data.regressors.transpose() * theta).squaredNorm();
  EXPECT_NEAR(MeanSquaredError(total, theta), squares / 350, 1e-12);
}

TEST(GramFit, TakingAStrokeOutAgainLeavesTheOthers) {
  const Synthetic data(3, 0.3);
  NormalEquations all, two;
  for (const StrokeGram& gram : data.strokes) all += IntegralEquations(gram, kColumns, 3);
  two += IntegralEquations(data.strokes[0], kColumns, 3);
  two += IntegralEquations(data.strokes[1], kColumns, 3);
  all -= IntegralEquations(data.strokes[2], kColumns, 3);
  EXPECT_LT((SolveNormalEquations(all) - SolveNormalEquations(two)).norm(), 1e-11);
  EXPECT_EQ(all.equations, two.equations);
}

TEST(GramFit, NoiseShareIsSubtractedUnlessItIsToBeKept) {
  Synthetic data(1, 0);
  StrokeGram& gram = data.strokes[0];
  for (int i = 0; i < 4; ++i) gram.noise(i, i) = 5;
  const auto kept = IntegralEquations(gram, kColumns, 3, NoiseCorrection::kKeep);
  const auto clean = IntegralEquations(gram, kColumns, 3);
  EXPECT_LT((kept.h - clean.h - 5 * MatrixXd::Identity(3, 3)).norm(), 1e-12);
  EXPECT_EQ(kept.g, clean.g);
}

TEST(GramFit, RegressorsThatAreNotIndependentHaveNoSolution) {
  NormalEquations e{MatrixXd::Ones(2, 2), VectorXd::Ones(2), 1, 10};
  EXPECT_EQ(SolveNormalEquations(e).size(), 0);
  e.h(1, 1) = 0;  // never excited
  EXPECT_EQ(SolveNormalEquations(e).size(), 0);
  e.h(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(SolveNormalEquations(e).size(), 0);
}

TEST(GramFit, SolutionDoesNotDependOnTheUnitsOfTheRegressors) {
  const Synthetic data(4, 0.1);
  NormalEquations e;
  for (const StrokeGram& gram : data.strokes) e += IntegralEquations(gram, kColumns, 3);
  const VectorXd theta = SolveNormalEquations(e);
  const VectorXd unit = Eigen::Vector3d(1e-9, 1e7, 1);
  NormalEquations scaled = e;
  scaled.h = unit.asDiagonal() * e.h * unit.asDiagonal();
  scaled.g = unit.asDiagonal() * e.g;
  const VectorXd other = SolveNormalEquations(scaled);
  ASSERT_EQ(other.size(), 3);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(other[i] * unit[i] / theta[i], 1.0, 1e-9);
}

TEST(GramFit, ExcitationIsTheShareTheOtherRegressorsDoNotExplain) {
  MatrixXd h(2, 2);
  h << 4, 4 * 0.6, 4 * 0.6, 4;
  EXPECT_NEAR(Excitation(h)[0], 1 - 0.36, 1e-12);
  EXPECT_NEAR(Excitation(MatrixXd(Eigen::Vector3d(1, 1e6, 1e-6).asDiagonal())).minCoeff(), 1.0, 1e-12);
}

TEST(GramFit, StudentFactorWidensTheNormalInterval) {
  EXPECT_NEAR(StudentFactor(10), 2.228139 / 1.959964, 1e-5);
  EXPECT_NEAR(StudentFactor(1), 12.7062 / 1.959964, 1e-4);
  EXPECT_NEAR(StudentFactor(1e6), 1.0, 1e-4);
  EXPECT_EQ(StudentFactor(0), std::numeric_limits<double>::infinity());
}

/// Strokes of the analytic press with sensor noise of the position, at various starting positions.
std::vector<StrokeGram> AnalyticStrokes(const ModelStructure& model,
                                        std::shared_ptr<const ModelStructure> shared, int count) {
  std::vector<StrokeGram> grams;
  const WindowSamples window;
  SpanEquationBuilder builder(shared, window);
  RandomStream random(9);
  for (int s = 0; s < count; ++s) {
    AnalyticStroke stroke(0.3 - 0.02 * s);
    stroke.Advance(0.37 * s);
    Stretch all = SampleStroke(model, stroke, 800, window.period);
    for (double& z : all.channel[kPosition]) z += 2e-5 * random.Normal();
    StrokeAccumulator accumulator(model.column_count());
    for (int p = 0; p < 4; ++p) {
      Stretch part = PartOf(all, 200 * p - (p > 0), 200 + (p > 0), p > 0);
      accumulator.Add(builder.Build(part, 0));
    }
    grams.push_back(accumulator.Take());
  }
  return grams;
}

TEST(GramFit, IntervalsHoldTheTruthOfTheAnalyticStroke) {
  const auto model = *BuildModel(AnalyticMachine());
  const auto fit = FitBaseModel(*model, AnalyticStrokes(*model, model, 8), WindowSamples{});
  ASSERT_TRUE(fit) << fit.error().text;
  const double truth[] = {AnalyticStroke::kBulk, AnalyticStroke::kDead, AnalyticStroke::kFlow,
                          AnalyticStroke::kNull};
  ASSERT_EQ(fit->parameters.size(), 4u);
  for (int i = 0; i < 4; ++i) {
    const Estimate& e = fit->parameters[i];
    EXPECT_LT(std::abs(e.value - truth[i]), 3 * e.std) << e.parameter << " " << e.value;
    EXPECT_LT(std::abs(e.value - truth[i]), 0.03 * truth[i]) << e.parameter << " " << e.value;
    EXPECT_EQ(e.reason, EstimateReason::kUpdated) << e.parameter;
    EXPECT_GT(e.excitation, 0);
    EXPECT_LE(e.excitation, 1);
  }
  EXPECT_EQ(fit->strokes, 8);
  EXPECT_NEAR(fit->rms_holdout / fit->noise_floor, 1.0, 0.25);
}

TEST(GramFit, OneStrokeGivesValuesWithoutInterval) {
  const auto model = *BuildModel(AnalyticMachine());
  const auto fit = FitBaseModel(*model, AnalyticStrokes(*model, model, 1), WindowSamples{});
  ASSERT_TRUE(fit);
  for (const Estimate& e : fit->parameters) {
    EXPECT_TRUE(std::isfinite(e.value));
    EXPECT_TRUE(std::isinf(e.std));
    EXPECT_EQ(e.reason, EstimateReason::kConfounded);
  }
}

TEST(GramFit, WithoutAStrokeTheErrorNamesTheGate) {
  const auto model = *BuildModel(AnalyticMachine());
  const auto fit = FitBaseModel(*model, {}, WindowSamples{});
  ASSERT_FALSE(fit);
  EXPECT_EQ(fit.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(fit.error().text, testing::HasSubstr("[gate]"));
  EXPECT_THAT(fit.error().text, testing::HasSubstr("no drawing stroke"));
}

TEST(GramFit, StrokesThatExciteTooLittleAreAnErrorThatSaysWhatToVary) {
  const auto model = *BuildModel(AnalyticMachine());
  StrokeGram empty{100,
                   5,
                   80,
                   SymmetricMatrix(model->column_count()),
                   SymmetricMatrix(model->column_count()),
                   SymmetricMatrix(model->column_count())};
  const auto fit = FitBaseModel(*model, {&empty, 1}, WindowSamples{});
  ASSERT_FALSE(fit);
  EXPECT_THAT(fit.error().text, testing::HasSubstr("vary ram speed and pressure"));
  StrokeGram in_pieces = empty;
  in_pieces.blocks = in_pieces.spans = 0;
  EXPECT_THAT(FitBaseModel(*model, {&in_pieces, 1}, WindowSamples{}).error().text,
              testing::HasSubstr("shorter than the 0.1 s that an equation needs"));
}

}  // namespace
}  // namespace hydroscope
