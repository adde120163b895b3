#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "estimation/decompositions.h"
#include "estimation/recursive/recursive_least_squares.h"
#include "simulator/random.h"

namespace hydroscope {
namespace {

using Rls = RecursiveLeastSquares;

constexpr double kLambda = 0.999;
constexpr int kUpdates = 1'000'000;
constexpr int kDayOfBlocks = 24 * 3600 * 50;  // 20 ms each
const Eigen::Vector4d kEnduring(-2, 0.5, 1, 3);

class Endurance : public testing::TestWithParam<Forgetting> {
 protected:
  Endurance() : rls_(std::vector<double>(4, 1.0), Options()), random_(42) {}

  static Rls::Options Options() {
    Rls::Options options;
    options.forgetting = GetParam();
    options.forgetting_factor = GetParam() == Forgetting::kNone ? 1.0 : kLambda;
    options.max_covariance = 1e6;
    return options;
  }
  void Learn(const Eigen::Vector4d& u, double y) { rls_.Update(std::span<const double>(u.data(), 4), y); }
  void Excite(int updates) {
    for (int k = 0; k < updates; ++k) {
      const double common = random_.Normal();
      const Eigen::Vector4d u(random_.Normal() + common, random_.Normal() + common, random_.Normal(), common);
      Learn(u, u.dot(kEnduring) + random_.Normal());
    }
  }
  void ExpectSound() const {
    const Eigen::MatrixXd p = rls_.Covariance();
    ASSERT_TRUE(p.allFinite());
    ASSERT_TRUE(rls_.theta().allFinite());
    EXPECT_EQ((p - p.transpose()).norm(), 0);
    EXPECT_GT(SymmetricFactor(p).LeastPivot(), 0);
    EXPECT_LE(p.diagonal().maxCoeff(), 1e6 / kLambda * 1.001);
  }
  void ExpectRight(double sigmas = 5) const {
    const Eigen::MatrixXd p = rls_.Covariance();
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(rls_.theta()[i], kEnduring[i], sigmas * std::sqrt(p(i, i))) << i;
  }

  Rls rls_;
  RandomStream random_;
};

TEST_P(Endurance, AMillionUpdatesStayFiniteSymmetricAndRight) {
  for (int part = 0; part < 10; ++part) {
    Excite(kUpdates / 10);
    ExpectSound();
    ExpectRight();
  }
}

TEST_P(Endurance, ADayOfZeroRegressorsChangesNothing) {
  Excite(20'000);
  const Eigen::VectorXd theta = rls_.theta();
  const Eigen::MatrixXd p = rls_.Covariance();
  const Eigen::Vector4d zero = Eigen::Vector4d::Zero();
  for (int k = 0; k < kDayOfBlocks; ++k) Learn(zero, random_.Normal());
  EXPECT_EQ(rls_.theta(), theta);
  EXPECT_EQ(rls_.Covariance(), p);
}

TEST_P(Endurance, ADayOfConstantRegressorsIsSurvivedAndThenUnlearned) {
  Excite(20'000);
  const Eigen::Vector4d u(1, 1, -1, 0.5);
  const double y = u.dot(kEnduring);
  for (int k = 0; k < kDayOfBlocks; ++k) Learn(u, y + random_.Normal());
  ExpectSound();
  // Directional forgetting holds what it knew; the exponential form may have let it go, but says so in P.
  ExpectRight();
  if (GetParam() == Forgetting::kDirectional) {
    EXPECT_LT(rls_.Covariance().diagonal().maxCoeff(), 0.02);  // as well known as before
  }
  Excite(20'000);
  ExpectSound();
  ExpectRight();
}

INSTANTIATE_TEST_SUITE_P(EveryForm, Endurance,
                         testing::Values(Forgetting::kNone, Forgetting::kExponential,
                                         Forgetting::kDirectional),
                         [](const auto& info) {
                           return std::string(info.param == Forgetting::kNone          ? "None"
                                              : info.param == Forgetting::kExponential ? "Exponential"
                                                                                       : "Directional");
                         });

}  // namespace
}  // namespace hydroscope
