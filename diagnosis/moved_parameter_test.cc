#include "diagnosis/moved_parameter.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

/// Two parameters that are their regression parameters: one with a size, one that may be zero.
ModelStructure TwoParameters() {
  ModelStructure model;
  model.base_count = 2;
  model.derive = [](const Eigen::VectorXd& theta) {
    return std::vector<DerivedParameter>{{"K", "Pa", theta[0], Eigen::Vector2d::UnitX()},
                                         {"y_0", "1", theta[1], Eigen::Vector2d::UnitY()}};
  };
  return model;
}

ExtendedFit FitAt(double first, double second, double first_std, double second_std) {
  ExtendedFit fit;
  fit.theta = Eigen::Vector2d(first, second);
  fit.covariance = Eigen::Vector2d(first_std * first_std, second_std * second_std).asDiagonal();
  return fit;
}

TEST(MovedParameter, IsOneThatMovesByMoreThanATenth) {
  const ExtendedFit as_is = FitAt(100, 0.5, 1, 1e-3);
  EXPECT_FALSE(FindMovedParameter(TwoParameters(), as_is, FitAt(92, 0.5, 1, 1e-3), 1.0 / 3));
  const auto moved = FindMovedParameter(TwoParameters(), as_is, FitAt(88, 0.5, 1, 1e-3), 1.0 / 3);
  ASSERT_TRUE(moved);
  EXPECT_EQ(moved->name, "K");
  EXPECT_NEAR(moved->share, -0.12, 1e-12);
  EXPECT_TRUE(moved->leaves_interval);
}

TEST(MovedParameter, SaysWhetherItStaysInItsInterval) {
  const ExtendedFit as_is = FitAt(100, 0.5, 10, 1e-3);
  EXPECT_FALSE(
      FindMovedParameter(TwoParameters(), as_is, FitAt(88, 0.5, 10, 1e-3), 1.0 / 3)->leaves_interval);
  const auto moved = FindMovedParameter(TwoParameters(), as_is, FitAt(88, 0.4, 10, 1e-3), 1.0 / 3);
  EXPECT_EQ(moved->name, "y_0") << "one that leaves it comes first";
}

/// However many times it grows.
TEST(MovedParameter, IsNoneNearZero) {
  const ExtendedFit as_is = FitAt(100, 1e-3, 1, 1e-3);
  EXPECT_FALSE(FindMovedParameter(TwoParameters(), as_is, FitAt(100, 0.03, 1, 1e-3), 1.0 / 3));
  EXPECT_FALSE(
      FindMovedParameter(TwoParameters(), FitAt(100, 1e-5, 1, 1e-7), FitAt(100, 0.01, 1, 1e-7), 1.0 / 3));
}

TEST(MovedParameter, OneWhoseZeroIsOneOfManyIsToldInItsUnit) {
  Machine press;
  press.model = "die_cushion";
  EXPECT_EQ(ChangeTold(KindOf(press), {"K", 0.124, true, 1.5e8, "Pa"}).english, "+12 %");
  EXPECT_EQ(ChangeTold(KindOf(press), {"y_0", 0.5, true, 0.004, "1"}).english, "+0.4 % of stroke");
}

}  // namespace
}  // namespace hydroscope
