#include "estimation/recursive/integral_estimator.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimation/analytic_stroke_fixture.h"
#include "estimation/stroke_accumulator.h"
#include "simulator/random.h"

namespace hydroscope {
namespace {

constexpr int kStretch = 200;  // samples

/// An estimator with the analytic press in front of it.
class Bench {
 public:
  /// `scatter`: standard deviation of the scale of the position, drawn for each stroke.
  explicit Bench(const EstimatorSpec& spec, double scatter = 0)
      : scatter_(scatter),
        model_(*BuildModel(AnalyticMachine())),
        estimator_(spec, model_, window_),
        builder_(model_, window_),
        accumulator_(model_->column_count()) {}

  /// Stroke number `index`, 1.6 s long, with noise of the position; every sample of `jump` gets 5 mm.
  void AddStretches(int index, bool jump = false) {
    Stretch all = Noisy(index, 4 * kStretch);
    for (int k = 301; jump && k < 400; ++k) all.channel[kPosition][k] += 5e-3;
    for (int p = 0; p < 4; ++p) Add(PartOf(all, kStretch * p - (p > 0), kStretch + (p > 0), p > 0));
  }
  /// One of 0.15 s, which says little.
  void AddShort(int index) { Add(Noisy(index, 75)); }
  std::vector<Estimate> EndStroke(double oil_temperature = 313.15) {
    StrokeSummary summary;
    summary.end = 10;
    summary.oil_temperature = oil_temperature;
    return estimator_.EndStroke(summary, accumulator_.Take());
  }
  void Discard() {
    accumulator_.Take();
    estimator_.DiscardStroke();
  }
  std::vector<Estimate> Strokes(int first, int last) {
    std::vector<Estimate> estimates;
    for (int s = first; s < last; ++s) {
      AddStretches(s);
      estimates = EndStroke();
    }
    return estimates;
  }
  IntegralEstimator& estimator() { return estimator_; }

 private:
  Stretch Noisy(int index, int samples) const {
    AnalyticStroke stroke(0.3 - 0.02 * (index % 8));
    stroke.Advance(0.37 * index);
    Stretch all = SampleStroke(*model_, stroke, samples, window_.period);
    RandomStream random(100 + static_cast<std::uint64_t>(index));
    const double scale = scatter_ > 0 ? 1 + scatter_ * random.Normal() : 1;
    for (double& position : all.channel[kPosition]) position = scale * position + 2e-5 * random.Normal();
    return all;
  }
  void Add(Stretch stretch) {
    const SpanEquations& equations = builder_.Build(stretch, 0);
    accumulator_.Add(equations);
    estimator_.AddStretch(stretch, equations);
  }

  double scatter_;
  WindowSamples window_;
  std::shared_ptr<const ModelStructure> model_;
  IntegralEstimator estimator_;
  SpanEquationBuilder builder_;
  StrokeAccumulator accumulator_;
};

TEST(IntegralEstimator, IntervalsHoldTheTruthOfTheAnalyticStroke) {
  Bench bench({});
  const auto estimates = bench.Strokes(0, 12);
  const double truth[] = {AnalyticStroke::kBulk, AnalyticStroke::kDead, AnalyticStroke::kFlow,
                          AnalyticStroke::kNull};
  ASSERT_EQ(estimates.size(), 4u);
  for (int i = 0; i < 4; ++i) {
    EXPECT_LT(std::abs(estimates[i].value - truth[i]), 3 * estimates[i].std) << estimates[i].parameter;
    EXPECT_LT(estimates[i].std, 0.02 * truth[i]) << estimates[i].parameter;
    EXPECT_NEAR(estimates[i].oil_temperature, 313.15, 1e-6);
  }
  EXPECT_EQ(bench.estimator().span_counts().learned, 48);
  EXPECT_EQ(bench.estimator().span_counts().in_dead_zone, 0);
}

TEST(IntegralEstimator, StrokesThatTellLittleNarrowNoInterval) {
  constexpr int kSets = 8, kLong = 3, kShort = 9;
  double ratios = 0;
  for (int set = 0; set < kSets; ++set) {
    Bench bench({}, 0.01);
    const int first = set * (kLong + kShort);
    const auto few = bench.Strokes(first, first + kLong);
    std::vector<Estimate> more;
    for (int s = 0; s < kShort; ++s) {
      bench.AddShort(first + kLong + s);
      more = bench.EndStroke();
    }
    ASSERT_EQ(few.size(), 4u);
    for (int i = 0; i < 4; ++i) ratios += more[i].std / few[i].std / (4 * kSets);
  }
  EXPECT_GT(ratios, 0.6);
}

TEST(IntegralEstimator, SpansWithinTheDeadZoneChangeNothingAndAreCounted) {
  EstimatorSpec spec;
  spec.dead_zone = 3;  // mere noise has 1
  Bench bench(spec);
  bench.Strokes(0, 4);
  const auto learned = bench.estimator().span_counts().learned;
  const Eigen::VectorXd theta = bench.estimator().theta();
  bench.Strokes(4, 8);
  EXPECT_EQ(bench.estimator().theta(), theta);
  EXPECT_EQ(bench.estimator().span_counts().learned, learned);
  EXPECT_GE(bench.estimator().span_counts().in_dead_zone, 16);
}

TEST(IntegralEstimator, SpansFarBeyondTheNoiseCountLess) {
  EstimatorSpec open;
  open.clip = 0;
  Bench clipped({}), unclipped(open);
  for (Bench* bench : {&clipped, &unclipped}) {
    bench->Strokes(0, 6);
    bench->AddStretches(6, true);
    bench->EndStroke();
  }
  EXPECT_GT(clipped.estimator().span_counts().clipped, 0);
  EXPECT_EQ(unclipped.estimator().span_counts().clipped, 0);
  const Eigen::VectorXd truth = AnalyticStroke::Theta();
  EXPECT_LT(std::abs(clipped.estimator().theta()[0] / truth[0] - 1),
            0.3 * std::abs(unclipped.estimator().theta()[0] / truth[0] - 1));
}

TEST(IntegralEstimator, StretchesThatWereNoStrokeLeaveNoTrace) {
  Bench with({}), without({});
  with.Strokes(0, 5);
  without.Strokes(0, 5);
  with.AddStretches(5);
  with.Discard();
  with.Strokes(6, 8);
  without.Strokes(6, 8);
  EXPECT_EQ(with.estimator().theta(), without.estimator().theta());
}

TEST(IntegralEstimator, TimeConstantsAreNamedByPhysicalOrRegressionParameter) {
  const auto theta = [](const std::string& name) {
    EstimatorSpec spec;
    spec.time_constants[name] = 3;
    Bench bench(spec);
    bench.Strokes(0, 3);
    return bench.estimator().theta();
  };
  EXPECT_EQ(theta("K"), theta("theta3"));
  EXPECT_EQ(theta("V0"), theta("theta2"));
  EXPECT_EQ(theta("Q_vn"), theta("theta1"));
  EXPECT_EQ(theta("y_0"), theta("theta4"));
  EXPECT_NE(theta("K"), theta("V0"));
}

TEST(IntegralEstimator, EstimatesOfWarmingOilNameATemperatureBehindThePresentOne) {
  EstimatorSpec spec;
  spec.time_constant = 5;
  Bench bench(spec);
  std::vector<Estimate> estimates;
  for (int s = 0; s < 20; ++s) {
    bench.AddStretches(s);
    estimates = bench.EndStroke(300.0 + s);
  }
  for (const Estimate& e : estimates) {
    EXPECT_LT(e.oil_temperature, 318.0) << e.parameter;
    EXPECT_GT(e.oil_temperature, 312.0) << e.parameter;
  }
}

TEST(IntegralEstimator, GoesOnFromASavedStateBitForBit) {
  for (const int strokes : {1, 6}) {
    Bench original({}), restored({});
    original.Strokes(0, strokes);
    ByteWriter out;
    original.estimator().Save(out);
    const auto bytes = out.Take();
    ByteReader in(bytes);
    ASSERT_TRUE(restored.estimator().Restore(in));
    EXPECT_TRUE(in.at_end());
    const auto a = original.Strokes(strokes, strokes + 3), b = restored.Strokes(strokes, strokes + 3);
    EXPECT_EQ(original.estimator().theta(), restored.estimator().theta());
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].std, b[i].std);
      EXPECT_EQ(a[i].oil_temperature, b[i].oil_temperature);
    }
  }
}

}  // namespace
}  // namespace hydroscope
