#include "estimation/error_trust.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hydroscope {
namespace {

constexpr double kEquations = 1000;

/// Two columns of unit rms whose parameters are 1, and of which the other explains all but `share`.
NormalEquations Alike(double share) {
  NormalEquations e{Eigen::MatrixXd(2, 2), Eigen::VectorXd(2), kEquations, kEquations};
  const double both = std::sqrt(1 - share);
  e.h << 1, both, both, 1;
  e.h *= kEquations;
  return e;
}

bool Carried(double share, double rms, double floor) {
  const NormalEquations e = Alike(share);
  return CarriedByError(e.h, e, Eigen::Vector2d(1, 1), rms, floor)[0];
}

TEST(CarriedByError, OnlyWhereColumnsAreAlikeAndTheErrorIsFarAboveTheNoise) {
  EXPECT_TRUE(Carried(1e-4, 0.01, 0.001)) << "ten times the error is ten times what the column has to itself";
  EXPECT_FALSE(Carried(1e-4, 0.01, 0.009)) << "the error is noise";
  EXPECT_FALSE(Carried(0.1, 0.1, 0.001)) << "the columns differ";
  EXPECT_FALSE(Carried(1e-4, 1e-4, 1e-5)) << "an error so small moves nothing";
}

}  // namespace
}  // namespace hydroscope
