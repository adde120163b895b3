#include "estimation/states/bounded_squares.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace hydroscope {
namespace {

/// Half the squares of `errors`, with `slopes` (error x unknown), within bounds; counts what is asked for.
struct Counted {
  std::function<Eigen::VectorXd(const Eigen::VectorXd&)> errors;
  std::function<Eigen::MatrixXd(const Eigen::VectorXd&)> slopes;
  int costs = 0, sums = 0;

  BoundedSquares Within(const Eigen::VectorXd& low, const Eigen::VectorXd& high) {
    return {low, high,
            [this](const Eigen::VectorXd& at) {
              ++costs;
              return 0.5 * errors(at).squaredNorm();
            },
            [this](const Eigen::VectorXd& at) {
              ++sums;
              const Eigen::VectorXd e = errors(at);
              const Eigen::MatrixXd j = slopes(at);
              return SquaresSum{0.5 * e.squaredNorm(), j.transpose() * e,
                                Eigen::MatrixXd(j.transpose() * j).sparseView(0, 0)};
            }};
  }
};

/// Two unknowns that nearly make up for each other; the first would go far beyond its bound.
Counted Slanted() {
  Eigen::MatrixXd slopes(3, 2);
  slopes << 1, 1, 1, 1.1, 0.1, 0;
  const Eigen::VectorXd measured = Eigen::Vector3d(2, 0, 1);
  return {[=](const Eigen::VectorXd& at) -> Eigen::VectorXd { return slopes * at - measured; },
          [=](const Eigen::VectorXd&) { return slopes; }};
}

TEST(BoundedSquares, WhatStandsAtABoundDoesNotSpoilTheStepsOfTheOthers) {
  Counted slanted = Slanted();
  const Eigen::Vector2d low(-1, -100), high(1, 100);
  Eigen::VectorXd at = Eigen::Vector2d(0, 50);
  const Descent descent = Minimise(slanted.Within(low, high), {.tolerance = 1e-12}, at);
  EXPECT_TRUE(descent.converged);
  EXPECT_EQ(at[0], 1);
  // The second alone: its column with what the first leaves.
  EXPECT_NEAR(at[1], (1 * (2 - 1) + 1.1 * (0 - 1)) / (1 + 1.1 * 1.1), 1e-3);
  EXPECT_LE(slanted.sums, 5);
}

TEST(BoundedSquares, LeavesABoundThatTheCostPushesAwayFrom) {
  Counted slanted = Slanted();
  Eigen::VectorXd at = Eigen::Vector2d(-1, -100);
  const Descent descent = Minimise(slanted.Within(Eigen::Vector2d(-1, -100), Eigen::Vector2d(1e3, 1e3)),
                                   {.iterations = 100, .tolerance = 1e-14}, at);
  EXPECT_TRUE(descent.converged);
  const Eigen::MatrixXd slopes = slanted.slopes(at);
  const Eigen::VectorXd free =
      (slopes.transpose() * slopes).inverse() * slopes.transpose() * -slanted.errors(Eigen::Vector2d::Zero());
  EXPECT_NEAR(at[0], free[0], 1e-3);
  EXPECT_NEAR(at[1], free[1], 1e-3);
}

/// Rosenbrock's valley (1960) with a wall: where the cost is not finite no step ends.
TEST(BoundedSquares, FollowsAValleyBesideAWall) {
  Counted valley{[](const Eigen::VectorXd& at) -> Eigen::VectorXd {
                   if (at[1] > 4) return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
                   return Eigen::Vector2d(10 * (at[1] - at[0] * at[0]), 1 - at[0]);
                 },
                 [](const Eigen::VectorXd& at) -> Eigen::MatrixXd {
                   Eigen::Matrix2d slopes;
                   slopes << -20 * at[0], 10, -1, 0;
                   return slopes;
                 }};
  const Eigen::VectorXd free = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::VectorXd at = Eigen::Vector2d(-1.2, 1);
  const Descent descent = Minimise(valley.Within(-free, free), {.tolerance = 1e-14}, at);
  EXPECT_TRUE(descent.begun);
  EXPECT_NEAR(at[0], 1, 1e-6);
  EXPECT_NEAR(at[1], 1, 1e-6);
  at = Eigen::Vector2d(0, 5);
  EXPECT_FALSE(Minimise(valley.Within(-free, free), {}, at).begun);
}

}  // namespace
}  // namespace hydroscope
