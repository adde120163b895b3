#include "estimation/states/fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "estimation/states/same_end.h"
#include "models/machine.h"

namespace hydroscope {
namespace {

/// A pendulum that swings undamped for a hundred turns and more: x'' = -w^2 x + u.
constexpr const char* kPendulum = R"toml([signals]
u = { column = "u", unit = "rad/s2" }
y = { column = "y", unit = "rad" }
[states]
x = { ddt = "v", initial = "estimate" }
v = { ddt = "-w^2*x + u", initial = "estimate" }
[outputs]
y = "x"
[parameters]
w = { start = 2.4, min = 2, max = 3, unit = "rad/s" }
)toml";
constexpr double kPendulumRate = 2.5;  // rad/s

/// The first `start_rows` of its rows tell its rate to 0.03 rad/s: over all of them a turn and more.
class FitOfALongRecord : public testing::TestWithParam<unsigned> {
 protected:
  void SetUp() override {
    constexpr int kRows = 5000;
    constexpr double kPeriod = 0.05, kSensor = 0.3;
    std::mt19937 random(GetParam());
    std::normal_distribution<double> normal;
    episode_.signal = RowMatrix::Zero(kRows, 2);
    for (int row = 0; row < kRows; ++row) {
      episode_.time.push_back(kPeriod * row);
      episode_.signal(row, 1) = std::cos(kPendulumRate * kPeriod * row) + kSensor * normal(random);
    }
    const auto machine = ParseMachine(kPendulum, "pendulum");
    ASSERT_TRUE(machine) << machine.error().text;
    model_ = BuildStateModel(*machine, {}).value();
    options_.start_rows = 100;
    options_.starts = 2;
  }

  Episode episode_;
  std::shared_ptr<const StateModel> model_;
  StateFitOptions options_;
};

TEST_P(FitOfALongRecord, IsTakenOnFromTheFirstRowsStepByStep) {
  const StateFit fit = FitStates(model_, std::span(&episode_, 1), options_);
  ASSERT_TRUE(fit.solved()) << fit.failed.english;
  EXPECT_NEAR(fit.parameters[0], kPendulumRate, 5e-4);
}

TEST_P(FitOfALongRecord, BeginsWhereShortSegmentsAreTakenOnStepByStep) {
  const auto start = ShootStart(model_, std::span(&episode_, 1), Eigen::VectorXd::Constant(1, 2.4), options_);
  ASSERT_TRUE(start);
  EXPECT_NEAR(start->parameters[0], kPendulumRate, 5e-4);
}

/// Models that are compared are weighted by the noise of one of them, which is a hundred times what another leaves.
TEST_P(FitOfALongRecord, IntervalsAreThoseOfWhatIsLeftWhateverTheWeights) {
  const StateStart start{Eigen::VectorXd::Constant(1, kPendulumRate), {}};
  const StateFit own = RefitStates(model_, std::span(&episode_, 1), std::span(&start, 1), {});
  const StateFit compared =
      RefitStates(model_, std::span(&episode_, 1), std::span(&start, 1), 100 * own.noise);
  EXPECT_NEAR(compared.covariance(0, 0), own.covariance(0, 0), 0.05 * own.covariance(0, 0));
}

TEST_P(FitOfALongRecord, TriesNoFurtherStartOnceOneLeavesWhiteNoise) {
  options_.start_rows = 1000;
  EXPECT_EQ(FitStates(model_, std::span(&episode_, 1), options_).starts_tried, 3);
  options_.until_white = true;
  EXPECT_EQ(FitStates(model_, std::span(&episode_, 1), options_).starts_tried, 1);
}

TEST_P(FitOfALongRecord, GivesUpStartsThatCostFarMoreThanOthers) {
  options_.most_effort = 0.01;
  const StateFit fit = FitStates(model_, std::span(&episode_, 1), options_);
  EXPECT_EQ(fit.starts_tried, 3);
  EXPECT_EQ(fit.starts_diverged, 2);
}

/// The machine file's start is right; of runs over 1000 rows others end turns away from it, with six times the squares.
TEST_P(FitOfALongRecord, WhereNotAllAreTriedGivesUpStartsThatErrFarMore) {
  std::string text = kPendulum;
  text.replace(text.find("start = 2.4"), 11, "start = 2.5");
  model_ = BuildStateModel(*ParseMachine(text, "pendulum"), {}).value();
  options_.start_rows = options_.segment_rows = 1000;
  options_.starts = 8;
  // What is left is no white noise.
  for (int row = 0; row < episode_.rows(); ++row) episode_.signal(row, 1) += 0.3 * std::sin(0.5 * row);
  const StateFit all = FitStates(model_, std::span(&episode_, 1), options_);
  EXPECT_EQ(all.starts_diverged, 0);
  EXPECT_GT(all.minima.size(), 1u);
  options_.until_agreed = 10;  // more than there are
  const StateFit best = FitStates(model_, std::span(&episode_, 1), options_);
  EXPECT_EQ(best.starts_tried, 9);
  EXPECT_EQ(best.starts_diverged, 9 - all.minima.front().starts);
  EXPECT_EQ(best.parameters, all.parameters);
}

TEST_P(FitOfALongRecord, TriesNoFurtherStartOnceEnoughAgree) {
  options_.start_rows = 1000;
  options_.starts = 8;
  // What is left is no white noise.
  for (int row = 0; row < episode_.rows(); ++row) episode_.signal(row, 1) += 0.3 * std::sin(0.5 * row);
  EXPECT_EQ(FitStates(model_, std::span(&episode_, 1), options_).starts_tried, 9);
  options_.until_agreed = 3;
  const StateFit fit = FitStates(model_, std::span(&episode_, 1), options_);
  ASSERT_TRUE(fit.solved()) << fit.failed.english;
  EXPECT_LT(fit.starts_tried, 9);
  EXPECT_EQ(fit.minima.front().starts, 3);
  EXPECT_NEAR(fit.parameters[0], kPendulumRate, 5e-4);
}

TEST_P(FitOfALongRecord, KnowsStartsThatLeadWhereAFitEnded) {
  const std::span<const Episode> episodes(&episode_, 1);
  const auto start = ShootStart(model_, episodes, Eigen::VectorXd::Constant(1, 2.4), options_);
  ASSERT_TRUE(start);
  const StateFit fit = RefitStates(model_, episodes, std::span(&*start, 1), {});
  EXPECT_TRUE(IsWhereItEnded(fit, episodes, *start, options_.same_minimum));
  StateStart beside = *start;
  beside.parameters[0] += 0.05;  // near it on its range, but a turn and more apart in the end
  EXPECT_FALSE(IsWhereItEnded(fit, episodes, beside, options_.same_minimum));
  StateStart afar = *start;
  afar.parameters[0] = 2.9;
  EXPECT_FALSE(IsWhereItEnded(fit, episodes, afar, 1e9));
}

/// A rounded edge that the input never comes near: its radius changes nothing where it is small.
TEST(Fit, FindsAParameterThatChangesNothingWhereItBegins) {
  constexpr double kRadius = 0.3;
  const auto machine = ParseMachine(R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "V" }
a = { column = "a", unit = "V" }
b = { column = "b", unit = "V" }
c = { column = "c", unit = "V" }
[states]
x = { ddt = "k*(u - x)", initial = "estimate" }
[outputs]
a = "x"
b = "2*x"
c = "x + r*ln(1 + exp(-abs(u)/r))"
[parameters]
k = { start = 2, min = 0.1, max = 100, unit = "1/s" }
r = { start = 1e-3, min = 1e-4, max = 1, unit = "V" }
)toml",
                                    "edge");
  ASSERT_TRUE(machine) << machine.error().text;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  constexpr int kRows = 600;
  constexpr double kPeriod = 0.01, kRate = 5, kNoise = 1e-3;
  Episode episode;
  episode.signal = RowMatrix::Zero(kRows, 4);
  double x = 0, u = 0;
  for (int row = 0; row < kRows; ++row) {
    x = u + (x - u) * std::exp(-kRate * kPeriod);  // held since the last row
    u = (row / 50 % 2 == 0 ? 1 : -1) * (0.2 + 0.1 * (row / 100));
    episode.time.push_back(kPeriod * row);
    episode.signal.row(row) << u, x, 2 * x, x + kRadius * std::log(1 + std::exp(-std::abs(u) / kRadius));
    for (int j = 1; j < 4; ++j) episode.signal(row, j) += kNoise * normal(random);
  }
  StateFitOptions options;
  options.starts = 0;
  const StateFit fit = FitStates(BuildStateModel(*machine, {}).value(), std::span(&episode, 1), options);
  ASSERT_TRUE(fit.solved()) << fit.failed.english;
  EXPECT_NEAR(fit.parameters[0], kRate, 0.01);
  EXPECT_NEAR(fit.parameters[1], kRadius, 0.001);
}

/// The sign of a is not seen: starts of either sign end at the same cost, at different a.
TEST(Fit, StartsOfOneCostAgreeOnlyWhereTheyEndAtTheSameParameters) {
  const auto machine = ParseMachine(R"toml([signals]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "V" }
[states]
x = { ddt = "-x + a^2*u", initial = 0 }
[outputs]
y = "x"
[parameters]
a = { start = 1.5, min = -3, max = 3 }
)toml",
                                    "square");
  ASSERT_TRUE(machine) << machine.error().text;
  const auto model = BuildStateModel(*machine, {}).value();
  Episode episode;
  episode.signal = RowMatrix::Zero(400, 2);
  double x = 0;
  for (int row = 0; row < 400; ++row) {
    episode.time.push_back(0.05 * row);
    episode.signal(row, 0) = row / 40 % 2;
    episode.signal(row, 1) = x + 0.05 * std::sin(0.3 * row);
    x += 0.05 * (4 * episode.signal(row, 0) - x);
  }
  StateFitOptions options;
  options.until_agreed = 5;
  const StateFit fit = FitStates(model, std::span(&episode, 1), options);
  ASSERT_TRUE(fit.solved()) << fit.failed.english;
  EXPECT_NEAR(std::abs(fit.parameters[0]), 2, 0.1);
  EXPECT_GT(fit.minima.front().starts, 5) << "of both signs";
}

INSTANTIATE_TEST_SUITE_P(Noise, FitOfALongRecord, testing::Values(1, 2, 3));

}  // namespace
}  // namespace hydroscope
