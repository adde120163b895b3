#include "estimation/stroke_clusters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/constants.h"
#include "estimation/gram_fit.h"

namespace hydroscope {
namespace {

/// Strokes of y = 2 x + 1 + noise, with errors of the slope that strokes of one group share.
struct Runs {
  std::vector<NormalEquations> equations;
  std::vector<StrokeOperation> operations;
  Eigen::VectorXd theta;

  enum class Share { kNothing, kLevel, kLog, kTime };

  Runs(Share share, std::uint64_t seed, int strokes = 40) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::vector<double> level_error(5), log_error(10);
    for (double& e : level_error) e = normal(random);
    for (double& e : log_error) e = normal(random);
    double wander = 0;
    NormalEquations total;
    for (int s = 0; s < strokes; ++s) {
      const int run = s / 4;  // four strokes at one level in a row, but for errors of the level
      const int level = share == Share::kLevel ? s % 5 : run % 5, log = share == Share::kTime ? 0 : run;
      wander = 0.95 * wander + 0.3 * normal(random);
      const double common = share == Share::kLevel  ? level_error[level]
                            : share == Share::kLog  ? log_error[log]
                            : share == Share::kTime ? wander
                                                    : 0.0;
      NormalEquations e{Eigen::Matrix2d::Zero(), Eigen::Vector2d::Zero(), 0, 0};
      Eigen::Vector2d square = Eigen::Vector2d::Zero();
      for (int k = 0; k < 20; ++k) {
        const Eigen::Vector2d row(1 + level + 0.1 * normal(random), 1);
        const double y = (2 + 0.3 * common) * row[0] + 1 + normal(random);
        e.h += row * row.transpose();
        e.g += y * row;
        e.yy += y * y;
        e.equations += 1;
        square += Eigen::Vector2d(row[0] * row[0], 1);
      }
      total += e;
      equations.push_back(e);
      operations.push_back({log, (square / 20).cwiseSqrt()});
    }
    theta = SolveNormalEquations(total);
  }

  StrokeClusters Find() const { return FindStrokeClusters(equations, operations, theta); }
  Eigen::MatrixXd ByStroke() const {
    return JackknifeCovariance(ReplicasWithoutClusters(equations, SingleStrokes(equations.size())));
  }
  Eigen::MatrixXd Covariance() const { return WidenedCovariance(equations, Find(), ByStroke()); }
};

/// How many of 200 sets hold the true slope 2 in the interval that `covariance` promises.
template <typename Covariance>
int Held(Runs::Share share, Covariance covariance) {
  int held = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Runs runs(share, seed);
    const double student = StudentFactor(static_cast<double>(runs.equations.size()) - 1);
    held += std::abs(runs.theta[0] - 2) <= kNormal95 * student * std::sqrt(covariance(runs)(0, 0));
  }
  return held;
}

TEST(StrokeClusters, IndependentStrokesStandForThemselves) {
  int grouped = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed)
    grouped += Runs(Runs::Share::kNothing, seed).Find().unit != ClusterUnit::kStroke;
  EXPECT_LE(grouped, 19) << "5 % are asked for; 9.5 % are three standard deviations more";
}

TEST(StrokeClusters, AnErrorThatStrokesShareIsFoundWhereItLies) {
  const auto found = [](Runs::Share share, ClusterUnit unit) {
    int count = 0;
    for (std::uint64_t seed = 0; seed < 50; ++seed) count += Runs(share, seed).Find().unit == unit;
    return count;
  };
  EXPECT_GE(found(Runs::Share::kLevel, ClusterUnit::kOperatingPoint), 45);
  EXPECT_GE(found(Runs::Share::kLog, ClusterUnit::kLog), 25);
  EXPECT_GE(found(Runs::Share::kTime, ClusterUnit::kTime), 25);
}

TEST(StrokeClusters, IntervalsHoldTheTruthWhereThoseByStrokeDoNot) {
  const auto by_stroke = [](const Runs& r) { return r.ByStroke(); };
  const auto by_group = [](const Runs& r) { return r.Covariance(); };
  EXPECT_LT(Held(Runs::Share::kLevel, by_stroke), 120);
  EXPECT_GE(Held(Runs::Share::kLevel, by_group), 178);
  EXPECT_LT(Held(Runs::Share::kLog, by_stroke), 150);
  EXPECT_GE(Held(Runs::Share::kLog, by_group), 178);
  const int independent = Held(Runs::Share::kNothing, by_group);
  EXPECT_GE(independent, 184);
}

/// Strokes of y = 2 x + noise; three of twenty have nearly all of x.
TEST(StrokeClusters, WhereAFewStrokesTellMostIntervalsGoByThose) {
  constexpr int kSets = 400, kStrokes = 20, kTelling = 3;
  const double reach = kNormal95 * StudentFactor(kStrokes - 1);
  int alike = 0, held = 0;
  for (std::uint64_t seed = 0; seed < kSets; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::vector<NormalEquations> strokes;
    NormalEquations total;
    for (int s = 0; s < kStrokes; ++s) {
      const double x = s < kTelling ? 2 : 0.1;
      NormalEquations e{Eigen::MatrixXd::Zero(1, 1), Eigen::VectorXd::Zero(1), 0, 0};
      for (int row = 0; row < 20; ++row) {
        e.h(0, 0) += x * x;
        e.g[0] += x * (2 * x + normal(random));
        e.equations += 1;
      }
      total += e;
      strokes.push_back(e);
    }
    const StrokeClusters single = SingleStrokes(kStrokes);
    const Eigen::MatrixXd jackknife = JackknifeCovariance(ReplicasWithoutClusters(strokes, single));
    const double error = std::abs(SolveNormalEquations(total)[0] - 2);
    alike += error <= reach * std::sqrt(jackknife(0, 0));
    held += error <= reach * std::sqrt(WidenedCovariance(strokes, single, jackknife)(0, 0));
    EXPECT_NEAR(StrokesThatTell(strokes, Eigen::MatrixXd::Identity(1, 1))[0], 3.1, 0.1);
  }
  EXPECT_LT(alike, 0.9 * kSets);
  EXPECT_GE(held, 0.94 * kSets);
}

TEST(StrokeClusters, FewStrokesAreNotGrouped) {
  EXPECT_EQ(Runs(Runs::Share::kLevel, 1, 7).Find().unit, ClusterUnit::kStroke);
}

}  // namespace
}  // namespace hydroscope
