#include "estimation/span_equations.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimation/analytic_stroke_fixture.h"
#include "estimation/stroke_accumulator.h"
#include "simulator/random.h"

namespace hydroscope {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Fixture {
  std::shared_ptr<const ModelStructure> model = *BuildModel(AnalyticMachine());
  WindowSamples window;

  explicit Fixture(int span = 20) { window.span = span; }
  /// Left side minus right side of the balance, equation by equation.
  VectorXd Misfit(const MatrixXd& equations, int count) const {
    const int output = model->output_column();
    return equations.row(output).head(count).transpose() -
           equations.topRows(output).leftCols(count).transpose() * VectorXd(AnalyticStroke::Theta());
  }
  double OutputNorm(const MatrixXd& equations, int count) const {
    return equations.row(model->output_column()).head(count).norm();
  }
};

/// A model of one base column and the output, both the level of channel 0, to look at the arithmetic alone.
std::shared_ptr<const ModelStructure> LevelModel() {
  auto model = std::make_shared<ModelStructure>();
  const auto level = [](const Stretch& s, double&, std::span<double> out) {
    const double* x = s[0];
    Differences(
        s, [=](int k) { return x[k]; }, out);
  };
  model->columns = {{"base", level}, {"output", level}};
  model->base_count = 1;
  model->channel_names = {"x"};
  model->channel_source = {0};
  model->derive_channels = [](Stretch&) {};
  model->integrated_noise = [](const Stretch&, int, int, Eigen::MatrixXd&) {};
  return model;
}

Stretch WhiteNoise(RandomStream& random, int samples, double period) {
  Stretch s;
  s.samples = samples;
  s.period = period;
  s.channel = {std::vector<double>(samples)};
  for (double& x : s.channel[0]) x = random.Normal();
  return s;
}

TEST(SpanEquations, ContrastsOfANoiseFreeStrokeSatisfyTheBalanceWithTheTrueParameters) {
  const Fixture f;
  AnalyticStroke stroke(0.2);
  // Sampled so finely that the trapezoidal rule itself errs by less than the test asks for.
  Stretch stretch = SampleStroke(*f.model, stroke, 200, 0.0002);
  WindowSamples fine = f.window;
  fine.period = 0.0002;
  SpanEquationBuilder builder(f.model, fine);
  const SpanEquations& e = builder.Build(stretch, 0);
  ASSERT_EQ(e.blocks, 20);
  EXPECT_LT(f.Misfit(e.integral, 19).norm() / f.OutputNorm(e.integral, 19), 1e-6);
}

TEST(SpanEquations, AtTheUsualSamplePeriodTheTrapezoidalRuleErrsByLessThanATenThousandth) {
  const Fixture f;
  SpanEquationBuilder builder(f.model, f.window);
  AnalyticStroke stroke(0.2);
  Stretch stretch = SampleStroke(*f.model, stroke, 200, f.window.period);
  const SpanEquations& e = builder.Build(stretch, 0);
  EXPECT_LT(f.Misfit(e.integral, 19).norm() / f.OutputNorm(e.integral, 19), 1e-4);
}

TEST(SpanEquations, FlowFormIsTheTrueFlowUnderTheTriangularWindow) {
  const Fixture f;
  SpanEquationBuilder builder(f.model, f.window);
  AnalyticStroke stroke(0.2);
  Stretch stretch = SampleStroke(*f.model, stroke, 200, f.window.period);
  const SpanEquations& e = builder.Build(stretch, 5.0);
  const int h = f.window.half_window, m = f.window.block;
  ASSERT_EQ(e.flow_time.size(), 20u - 2 * h + 1);
  const int output = f.model->output_column();
  for (std::size_t w = 0; w < e.flow_time.size(); ++w) {
    // Difference of the mean volumes of the two halves over the distance of their centres.
    const int first = static_cast<int>(w) * m, half = h * m;
    double before = 0, after = 0;
    for (int k = 0; k < half; ++k) {
      before += AnalyticStroke::kArea * stretch[kPosition][first + k] / half;
      after += AnalyticStroke::kArea * stretch[kPosition][first + half + k] / half;
    }
    EXPECT_NEAR(e.flow(output, w), (after - before) / (half * f.window.period), 1e-9);
    EXPECT_NEAR(e.flow_time[w], 5.0 + (first + half) * f.window.period, 1e-12);
  }
  const int windows = static_cast<int>(e.flow_time.size());
  EXPECT_LT(f.Misfit(e.flow, windows).norm() / f.OutputNorm(e.flow, windows), 1e-4);
}

TEST(SpanEquations, AFlowThatIsConstantIsThatFlow) {
  const auto model = LevelModel();
  WindowSamples window;
  Stretch ramp = {.samples = 200, .period = window.period, .channel = {std::vector<double>(200)}};
  for (int k = 0; k < 200; ++k) ramp.channel[0][k] = 7 - 3.5e-4 * k * window.period;
  SpanEquationBuilder builder(model, window);
  const SpanEquations& e = builder.Build(ramp, 0);
  for (std::size_t w = 0; w < e.flow_time.size(); ++w) EXPECT_NEAR(e.flow(1, w), -3.5e-4, 1e-12);
}

TEST(SpanEquations, ContrastsOfWhiteNoiseAreWhite) {
  const auto model = LevelModel();
  const WindowSamples window;
  SpanEquationBuilder builder(model, window);
  RandomStream random(1);
  const int spans = 4000, equations = window.span - 1;
  MatrixXd gram = MatrixXd::Zero(equations, equations);
  for (int s = 0; s < spans; ++s) {
    Stretch stretch = WhiteNoise(random, 200, window.period);
    const VectorXd row = builder.Build(stretch, 0).integral.row(0).head(equations).transpose();
    gram += row * row.transpose() / spans;
  }
  // A block mean of 10 samples has a tenth of the variance; 4000 spans know it to 2 %.
  const double expected = 1.0 / window.block, tolerance = 5 * expected / std::sqrt(spans);
  for (int i = 0; i < equations; ++i)
    for (int j = 0; j <= i; ++j)
      EXPECT_NEAR(gram(i, j), i == j ? expected : 0.0, (i == j ? 1.5 : 1) * tolerance);
}

TEST(SpanEquations, AConstantLevelGivesNoEquation) {
  const auto model = LevelModel();
  const WindowSamples window;
  SpanEquationBuilder builder(model, window);
  Stretch constant = {.samples = 200, .period = window.period, .channel = {std::vector<double>(200, 1e6)}};
  EXPECT_EQ(builder.Build(constant, 0).integral.row(0).head(19).norm(), 0.0);
}

TEST(SpanEquations, NoiseMatrixHoldsTheNoiseOfTheContrastsAndNeitherLevelNorSlope) {
  const auto model = LevelModel();
  for (int block : {8, 10, 11}) {
    WindowSamples window;
    window.block = block;
    SpanEquationBuilder builder(model, window);
    StrokeAccumulator noisy(2), smooth(2);
    RandomStream random(block);
    for (int s = 0; s < 3000; ++s) {
      Stretch stretch = WhiteNoise(random, 20 * block, window.period);
      noisy.Add(builder.Build(stretch, 0));
      for (int k = 0; k < stretch.samples; ++k) stretch.channel[0][k] = 5 - 3 * k;
      smooth.Add(builder.Build(stretch, 0));
    }
    const StrokeGram gram = noisy.Take();
    EXPECT_NEAR(gram.noise(0, 0) / gram.integral(0, 0), 1.0, 0.03) << block;
    EXPECT_LT(smooth.Take().noise(0, 0), 1e-20);
  }
}

/// Energy that pressure noise gives each column's equations, found from many draws, and what the noise
/// matrices say of it.
TEST(SpanEquations, PressureNoiseInFlowsThroughTheValveIsCountedForEveryColumnThatHasIt) {
  const Fixture fixture(25);
  AnalyticStroke stroke(0.2);
  const Stretch clean = SampleStroke(*fixture.model, stroke, 250, fixture.window.period);
  SpanEquationBuilder builder(fixture.model, fixture.window);
  const auto columns = fixture.model->column_count();
  const int equations = fixture.window.span - 1, draws = 400;
  MatrixXd mean = MatrixXd::Zero(columns, equations);
  VectorXd squares = VectorXd::Zero(columns), counted = squares;
  RandomStream random(5);
  for (int d = 0; d < draws; ++d) {
    Stretch noisy = clean;
    for (double& p : noisy.channel[kPressureA]) p += 2.2e5 * random.Normal();
    const SpanEquations& e = builder.Build(noisy, 0);
    mean += e.integral.leftCols(equations) / draws;
    squares += e.integral.leftCols(equations).rowwise().squaredNorm() / draws;
    counted += (e.noise.leftCols(e.blocks).rowwise().squaredNorm() + e.walk.rowwise().squaredNorm()) / draws;
  }
  const VectorXd energy = squares - mean.rowwise().squaredNorm();
  int walking = 0;
  for (int c = 0; c < columns; ++c) {
    if (!fixture.model->columns[c].walks || energy[c] == 0) continue;  // one edge is never open
    ++walking;
    EXPECT_NEAR(counted[c] / energy[c], 1.0, 0.15) << fixture.model->columns[c].name;
  }
  EXPECT_GT(walking, 15);
}

TEST(SpanEquations, AStrokeInPiecesHasTheLevelsOfTheWhole) {
  const Fixture whole(40), piece(10);
  AnalyticStroke stroke(0.2);
  const Stretch all = SampleStroke(*whole.model, stroke, 400, whole.window.period);
  Stretch copy = all;
  const SpanEquations reference = SpanEquationBuilder(whole.model, whole.window).Build(copy, 0);
  SpanEquationBuilder builder(piece.model, piece.window);
  const int m = piece.window.block, base = piece.model->base_count;
  int window = 0;
  for (int p = 0; p < 4; ++p) {
    Stretch part = p == 0 ? PartOf(all, 0, 10 * m, false) : PartOf(all, 10 * m * p - 1, 10 * m + 1, true);
    const SpanEquations& e = builder.Build(part, 10 * m * p * piece.window.period);
    EXPECT_EQ(e.blocks, 10);
    for (std::size_t w = 0; w < e.flow_time.size(); ++w, ++window) {
      EXPECT_NEAR(e.flow_time[w], reference.flow_time[window], 1e-12);
      for (int c = 0; c <= base; ++c)
        EXPECT_NEAR(e.flow(c, w), reference.flow(c, window),
                    1e-9 * reference.flow.row(c).cwiseAbs().maxCoeff())
            << "column " << c << " window " << window;
    }
  }
  EXPECT_EQ(window,
            static_cast<int>(reference.flow_time.size()));  // windows across the borders are there, once
}

TEST(SpanEquations, ANewSegmentKnowsNothingOfTheOneBefore) {
  const Fixture f;
  AnalyticStroke stroke(0.2);
  const Stretch all = SampleStroke(*f.model, stroke, 400, f.window.period);
  SpanEquationBuilder used(f.model, f.window), fresh(f.model, f.window);
  Stretch first = PartOf(all, 0, 200, false);
  used.Build(first, 0);
  Stretch second = PartOf(all, 200, 200, false), again = second;
  const SpanEquations& a = used.Build(second, 0.4);
  const SpanEquations& b = fresh.Build(again, 0.4);
  EXPECT_EQ(a.flow_time, b.flow_time);
  EXPECT_EQ(a.integral.leftCols(19), b.integral.leftCols(19));
}

TEST(WindowSamples, CountTimesInSamplesWithinSensibleLimits) {
  const WindowSpec spec;
  const WindowSamples usual = WindowSamples::From(spec, 0.002);
  EXPECT_EQ(usual.block, 10);
  EXPECT_EQ(usual.span, 28);
  EXPECT_EQ(usual.half_window, 2);
  const WindowSamples slow = WindowSamples::From(spec, 0.05);
  EXPECT_EQ(slow.block, 4);
  EXPECT_GE(slow.span, slow.min_span);
  EXPECT_GE(slow.half_window, 1);
}

}  // namespace
}  // namespace hydroscope
