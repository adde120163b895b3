#include "estimation/recursive/information_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "estimation/decompositions.h"
#include "simulator/random.h"

namespace hydroscope {
namespace {

using Matrix = InformationFilter::Matrix;
using Vector = InformationFilter::Vector;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
const Vector kTruth = Eigen::Vector3d(2, -1, 0.5);

/// Normal equations of `count` equations with parameters `theta`, whose regressors move `directions` only.
struct Batch {
  Matrix gram = Matrix::Zero(3, 3);
  Vector cross = Vector::Zero(3);

  Batch(RandomStream& random, int count, const Vector& theta, double noise, const Matrix& directions) {
    for (int k = 0; k < count; ++k) {
      Vector u = Vector::Zero(3);
      for (Eigen::Index d = 0; d < directions.cols(); ++d) u += random.Normal() * directions.col(d);
      gram += u * u.transpose();
      cross += u * (u.dot(theta) + noise * random.Normal());
    }
  }
};

const Matrix kAll = Matrix::Identity(3, 3);

InformationFilter Fresh() { return {Vector::Zero(3), 1e8, 1e10}; }

double LargestVariance(const InformationFilter& filter) {
  return 1.0 / EigenOf(filter.information()).values[0];
}

TEST(InformationFilter, WithoutForgettingItIsLeastSquaresOverAllBatches) {
  RandomStream random(1);
  InformationFilter filter = Fresh();
  Matrix gram = Matrix::Zero(3, 3);
  Vector cross = Vector::Zero(3);
  for (int k = 0; k < 20; ++k) {
    const Batch batch(random, 30, kTruth, 0.5, kAll);
    filter.Add(batch.gram, batch.cross, kUnknown);
    gram += batch.gram;
    cross += batch.cross;
  }
  EXPECT_LT((filter.Theta() - SymmetricFactor(gram).Solve(cross)).norm(), 1e-7);
  EXPECT_LT((filter.Covariance() * gram - kAll).norm(), 1e-6);
}

TEST(InformationFilter, ForgettingEveryDirectionScalesTheInformationAndKeepsTheParameters) {
  RandomStream random(2);
  InformationFilter filter = Fresh();
  const Batch batch(random, 50, kTruth, 0.5, kAll);
  filter.Add(batch.gram, batch.cross, 300.0);
  const Matrix information = filter.information();
  const Vector theta = filter.Theta();
  filter.Forget(kAll, 0.7);
  EXPECT_LT((filter.information() - 0.7 * information).norm(), 1e-10 * information.norm());
  EXPECT_LT((filter.Theta() - theta).norm(), 1e-10);
  EXPECT_LT((filter.Condition().array() - 300.0).abs().maxCoeff(), 1e-8);
}

TEST(InformationFilter, DirectionalForgettingLeavesTheOtherDirectionsTheirInformation) {
  RandomStream random(3);
  InformationFilter filter = Fresh();
  const Batch batch(random, 50, kTruth, 0.5, kAll);
  filter.Add(batch.gram, batch.cross, kUnknown);
  const Matrix before = filter.information();
  const Vector theta = filter.Theta();
  const Matrix excited = kAll.leftCols(1);
  filter.Forget(excited, 0.6);
  // Along the excited direction the share 0.6 is left; what is known of the rest once that is free is untouched.
  EXPECT_NEAR(filter.information()(0, 0), 0.6 * before(0, 0), 1e-9 * before(0, 0));
  const auto rest = [](const Matrix& r) {
    return Eigen::MatrixXd(r.bottomRightCorner(2, 2) -
                           r.bottomLeftCorner(2, 1) * r.topRightCorner(1, 2) / r(0, 0));
  };
  EXPECT_LT((rest(filter.information()) - rest(before)).norm(), 1e-9 * before.norm());
  EXPECT_LT((filter.Theta() - theta).norm(), 1e-9);
}

TEST(InformationFilter, FollowsAParameterInTheExcitedDirectionWhileTheOthersStand) {
  RandomStream random(4);
  InformationFilter filter = Fresh();
  const Batch start(random, 300, kTruth, 0.1, kAll);
  filter.Add(start.gram, start.cross, kUnknown);
  const Vector before = filter.Theta();
  const Vector moved = kTruth + Vector(Eigen::Vector3d(1, 0, 0));
  for (int k = 0; k < 60; ++k) {
    const Batch batch(random, 30, moved, 0.1, kAll.leftCols(1));
    filter.Forget(kAll.leftCols(1), 0.8);
    filter.Add(batch.gram, batch.cross, kUnknown);
  }
  EXPECT_NEAR(filter.Theta()[0], moved[0], 0.05);
  EXPECT_NEAR(filter.Theta()[1], before[1], 0.05);
  EXPECT_NEAR(filter.Theta()[2], before[2], 0.05);
}

TEST(InformationFilter, CovarianceStaysWithinItsBoundHoweverMuchIsForgotten) {
  RandomStream random(5);
  InformationFilter filter(Vector::Zero(3), 1e3, 1e4);
  const Batch batch(random, 300, kTruth, 0.1, kAll);
  filter.Add(batch.gram, batch.cross, 310.0);
  const Vector theta = filter.Theta();
  for (int k = 0; k < 2000; ++k) filter.Forget(kAll, 0.9);
  EXPECT_NEAR(LargestVariance(filter), 1e4, 1);
  EXPECT_LT((filter.Theta() - theta).norm(), 1e-9);
  EXPECT_LT((filter.Condition().array() - 310.0).abs().maxCoeff(), 1e-6);
}

TEST(InformationFilter, NoiseShareLargerThanTheGramLeavesTheCovariancePositive) {
  InformationFilter filter(kTruth, 1e3, 1e4);
  for (int k = 0; k < 1000; ++k) filter.Add(-1e-3 * kAll, Vector::Zero(3), kUnknown);
  EXPECT_LE(LargestVariance(filter), 1.0001e4);
  EXPECT_GT(LargestVariance(filter), 0);
  EXPECT_LT((filter.Theta() - kTruth).norm(), 1e-9);
}

TEST(InformationFilter, AnEstimateThatLagsIsTheParameterAtTheConditionItNames) {
  RandomStream random(6);
  const auto at = [](double condition) {
    return Vector(kTruth + 0.05 * (condition - 300.0) * Vector(Eigen::Vector3d(1, 0, 0)));
  };
  InformationFilter filter(at(300.0), 1e8, 1e10);
  double condition = 300.0;
  for (int k = 0; k < 80; ++k, condition += 0.1) {
    // Excitation that changes from batch to batch, and forgetting of two directions only.
    const Matrix directions =
        (Matrix(3, 2) << 1, 0.2 * std::sin(0.3 * k), 0.5, 1, 0.1 * (k % 7), -0.4).finished();
    const Batch batch(random, 30, at(condition), 0, k % 2 == 0 ? kAll : directions);
    if (k > 0) filter.Forget(kAll.leftCols(2), 0.9);
    filter.Add(batch.gram, batch.cross, condition);
  }
  const double named = filter.Condition()[0];
  EXPECT_LT(named, condition - 0.5);
  EXPECT_NEAR(filter.Theta()[0], at(named)[0], 1e-6);
}

TEST(InformationFilter, AnUnknownConditionChangesNothingAboutTheOneRemembered) {
  RandomStream random(7);
  InformationFilter filter = Fresh();
  const Batch batch(random, 30, kTruth, 0, kAll);
  filter.Add(batch.gram, batch.cross, kUnknown);
  EXPECT_TRUE(filter.Condition().hasNaN());
  filter.Add(batch.gram, batch.cross, 305.0);
  filter.Add(batch.gram, batch.cross, kUnknown);
  EXPECT_LT((filter.Condition().array() - 305.0).abs().maxCoeff(), 1e-8);
}

TEST(InformationFilter, StaysRightAndSymmetricOverManyBatchesAtAShortMemory) {
  RandomStream random(8);
  InformationFilter filter = Fresh();
  for (int k = 0; k < 20000; ++k) {
    const Batch batch(random, 4, kTruth, 0.2, kAll.leftCols(1 + k % 3));
    filter.Forget(kAll.leftCols(1 + k % 3), 0.99);
    filter.Add(25.0 * batch.gram, 25.0 * batch.cross, 300.0);
  }
  EXPECT_EQ((filter.information() - filter.information().transpose()).norm(), 0);
  for (int i = 0; i < 3; ++i)
    EXPECT_LT(std::abs(filter.Theta()[i] - kTruth[i]), 5 * std::sqrt(filter.Covariance()(i, i)));
  EXPECT_LT((filter.Condition().array() - 300.0).abs().maxCoeff(), 1e-6);
}

}  // namespace
}  // namespace hydroscope
