#include "estimation/linear_form/base_parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace hydroscope {
namespace {

using testing::ElementsAre;

Eigen::MatrixXd Random(int rows, int columns) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

TEST(BaseParameters, GroupWhatActsAlikeWithWhatStandsBeforeIt) {
  Eigen::MatrixXd regressor = Random(200, 4);
  regressor.col(3) = 1.6 * regressor.col(0) + 2.56 * regressor.col(2);
  const BaseParameterSet base = FindBaseParameters(regressor);
  EXPECT_EQ(base.rank, 3);
  EXPECT_THAT(base.kept, ElementsAre(0, 1, 2));
  EXPECT_NEAR(base.combination(0, 3), 1.6, 1e-9);
  EXPECT_EQ(base.combination(1, 3), 0);
  EXPECT_NEAR(base.combination(2, 3), 2.56, 1e-9);
}

TEST(BaseParameters, SeeNothingOfAColumnThatIsZero) {
  Eigen::MatrixXd regressor = Random(200, 3);
  regressor.col(1).setZero();
  const BaseParameterSet base = FindBaseParameters(regressor);
  EXPECT_THAT(base.unseen, ElementsAre(1));
  EXPECT_THAT(base.kept, ElementsAre(0, 2));
}

TEST(BaseParameters, AreTheSameInAnyUnit) {
  Eigen::MatrixXd regressor = Random(200, 3);
  regressor.col(2) = 2 * regressor.col(0) - regressor.col(1);
  const BaseParameterSet base = FindBaseParameters(regressor);
  Eigen::MatrixXd small = regressor;
  small.col(0) *= 1e-9;
  const BaseParameterSet scaled = FindBaseParameters(small);
  EXPECT_EQ(scaled.kept, base.kept);
  EXPECT_NEAR(scaled.combination(0, 2), 2e9, 1);
  EXPECT_NEAR(scaled.condition, base.condition, 1e-6);
}

TEST(BaseParameters, HaveTheConditionOfWhatIsNearlyAlike) {
  Eigen::MatrixXd regressor = Random(500, 2);
  EXPECT_LT(FindBaseParameters(regressor).condition, 1.3);
  regressor.col(1) = regressor.col(0) + 0.01 * regressor.col(1);
  EXPECT_GT(FindBaseParameters(regressor).condition, 100);
}

}  // namespace
}  // namespace hydroscope
