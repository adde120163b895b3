#include "estimation/recursive/recursive_least_squares.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "estimation/decompositions.h"
#include "simulator/random.h"

namespace hydroscope {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Rls = RecursiveLeastSquares;

constexpr double kAlpha = 500.0;

struct Equation {
  VectorXd u;
  double y;
};

VectorXd Truth(int n) { return VectorXd::LinSpaced(n, -2.0, 3.0); }

/// Regressors with a common part (so that they are correlated), output with unit noise.
Equation Draw(RandomStream& random, const VectorXd& theta) {
  Equation e{VectorXd(theta.size()), 0};
  const double common = random.Normal();
  for (double& u : e.u) u = random.Normal() + common;
  e.y = e.u.dot(theta) + random.Normal();
  return e;
}

Rls Make(const Rls::Options& options, int n, double initial = 1.0) {
  const std::vector<double> theta(n, initial);
  return Rls(theta, options);
}

Rls::Options With(Forgetting forgetting, double lambda) {
  Rls::Options options;
  options.forgetting = forgetting;
  options.forgetting_factor = lambda;
  options.initial_covariance = kAlpha;
  return options;
}

UpdateOutcome Take(Rls& rls, const Equation& e) {
  return rls.Update(std::span<const double>(e.u.data(), e.u.size()), e.y);
}

/// The laws in information form, as the literature states them: R = P^-1.
struct InformationForm {
  MatrixXd r;
  VectorXd theta;

  explicit InformationForm(int n) : r(MatrixXd::Identity(n, n) / kAlpha), theta(VectorXd::Ones(n)) {}
  void Learn(const Equation& e) {
    r += e.u * e.u.transpose();
    theta += r.ldlt().solve(e.u) * (e.y - e.u.dot(theta));
  }
};

/// Smallest pivot: above 0 for a positive definite matrix.
double Smallest(const MatrixXd& p) { return SymmetricFactor(p).LeastPivot(); }

TEST(RecursiveLeastSquares, WithoutForgettingEqualsBatchLeastSquaresForEveryNumberOfParameters) {
  for (int n = 1; n <= Rls::kMaxParameters; ++n) {
    RandomStream random(n);
    Rls rls = Make(With(Forgetting::kNone, 1.0), n);
    MatrixXd h = MatrixXd::Identity(n, n) / kAlpha;
    VectorXd g = VectorXd::Ones(n) / kAlpha;  // the prior: theta(0) = 1 with covariance alpha
    for (int k = 0; k < 400; ++k) {
      const Equation e = Draw(random, Truth(n));
      EXPECT_EQ(Take(rls, e), UpdateOutcome::kUpdated);
      h += e.u * e.u.transpose();
      g += e.u * e.y;
    }
    EXPECT_LT((rls.theta() - SymmetricFactor(h).Solve(g)).norm(), 1e-9) << n;
    EXPECT_LT((rls.Covariance() * h - MatrixXd::Identity(n, n)).norm(), 1e-9) << n;
    EXPECT_EQ(rls.updates(), 400);
  }
}

TEST(RecursiveLeastSquares, ExponentialFormEqualsLeastSquaresWithFadingWeights) {
  constexpr double kLambda = 0.98;
  for (int n : {1, 4, 7}) {
    RandomStream random(10 + n);
    Rls rls = Make(With(Forgetting::kExponential, kLambda), n);
    MatrixXd h = MatrixXd::Identity(n, n) / kAlpha;
    VectorXd g = VectorXd::Ones(n) / kAlpha;
    for (int k = 0; k < 600; ++k) {
      const Equation e = Draw(random, Truth(n));
      Take(rls, e);
      h = kLambda * h + e.u * e.u.transpose();
      g = kLambda * g + e.u * e.y;
    }
    EXPECT_LT((rls.theta() - SymmetricFactor(h).Solve(g)).norm(), 1e-9) << n;
    EXPECT_LT((rls.Covariance() * h - MatrixXd::Identity(n, n)).norm(), 1e-9) << n;
  }
}

TEST(RecursiveLeastSquares, DirectionalFormEqualsTheInformationFormOfLaiAndBernstein) {
  constexpr double kLambda = 0.95;
  for (int n : {1, 2, 4, 8, 12}) {
    RandomStream random(20 + n);
    Rls rls = Make(With(Forgetting::kDirectional, kLambda), n);
    InformationForm reference(n);
    for (int k = 0; k < 500; ++k) {
      const Equation e = Draw(random, Truth(n));
      const VectorXd ru = reference.r * e.u;
      reference.r -= (1 - kLambda) / e.u.dot(ru) * ru * ru.transpose();
      reference.Learn(e);
      Take(rls, e);
    }
    EXPECT_LT((rls.theta() - reference.theta).norm(), 1e-8) << n;
    EXPECT_LT((rls.Covariance() * reference.r - MatrixXd::Identity(n, n)).norm(), 1e-8) << n;
  }
}

TEST(RecursiveLeastSquares, OneFactorPerParameterForgetsWithTheMeanWeightedByTheRegressor) {
  Rls::Options options = With(Forgetting::kDirectional, 0.99);
  options.factors = {0.9, 0.99, 0.999};
  Rls rls = Make(options, 3);
  InformationForm reference(3);
  RandomStream random(3);
  for (int k = 0; k < 400; ++k) {
    const Equation e = Draw(random, Truth(3));
    const Eigen::Array3d energy = e.u.array().square();
    const double lambda = (energy * Eigen::Array3d(0.9, 0.99, 0.999)).sum() / energy.sum();
    const VectorXd ru = reference.r * e.u;
    reference.r -= (1 - lambda) / e.u.dot(ru) * ru * ru.transpose();
    reference.Learn(e);
    Take(rls, e);
  }
  EXPECT_LT((rls.theta() - reference.theta).norm(), 1e-8);
}

TEST(RecursiveLeastSquares, EachParameterForgetsWithItsOwnFactorWhenExcitedAlone) {
  Rls::Options options = With(Forgetting::kDirectional, 0.99);
  options.factors = {0.9, 0, 1.0};  // 0 = the common 0.99
  Rls rls = Make(options, 3);
  for (int k = 0; k < 5000; ++k) {
    VectorXd u = VectorXd::Zero(3);
    u[k % 3] = 1.0;
    Take(rls, {u, 0.0});
  }
  const MatrixXd p = rls.Covariance();
  EXPECT_NEAR(p(0, 0), 1 - 0.9, 1e-9);  // information 1 / (1 - lambda) at rest
  EXPECT_NEAR(p(1, 1), 1 - 0.99, 1e-9);
  EXPECT_NEAR(1 / p(2, 2), 1666 + 1 / kAlpha, 1e-6);  // never forgotten: one per equation
}

TEST(RecursiveLeastSquares, DirectionalFormLeavesUnexcitedDirectionsAsTheyWere) {
  constexpr double kLambda = 0.999;
  Rls rls = Make(With(Forgetting::kDirectional, kLambda), 4);
  const Eigen::Vector4d direction = Eigen::Vector4d(1, -2, 0.5, 3).normalized();
  const MatrixXd others =
      MatrixXd(direction).householderQr().householderQ() * MatrixXd::Identity(4, 4).rightCols(3);
  RandomStream random(5);
  for (int k = 0; k < 1'000'000; ++k) Take(rls, {direction, 7.0 + random.Normal()});
  const MatrixXd p = rls.Covariance();
  const MatrixXd kept = others.transpose() * p * others;
  EXPECT_LT((kept - kAlpha * MatrixXd::Identity(3, 3)).norm(), 1e-6);
  const VectorXd moved = others.transpose() * (rls.theta() - VectorXd::Ones(4));
  EXPECT_LT(moved.norm(), 1e-9);
  EXPECT_NEAR(direction.dot(p * direction), 1 - kLambda, 1e-8);  // the excited one forgets and stays bounded
  EXPECT_NEAR(direction.dot(rls.theta()), 7.0, 5 * std::sqrt(1 - kLambda));
}

TEST(RecursiveLeastSquares, DirectionalFormNeverLosesInformationOutsideTheExcitedDirection) {
  Rls rls = Make(With(Forgetting::kDirectional, 0.99), 4);
  RandomStream random(6);
  for (int k = 0; k < 2000; ++k) Take(rls, Draw(random, Truth(4)));
  const MatrixXd before = rls.Covariance();
  const VectorXd u = VectorXd::Unit(4, 2);
  for (int k = 0; k < 100'000; ++k) Take(rls, {u, Truth(4)[2] + random.Normal()});
  const MatrixXd after = rls.Covariance();
  for (int i : {0, 1, 3}) EXPECT_LE(after(i, i), before(i, i) * (1 + 1e-9)) << i;
  EXPECT_LE(after(2, 2), 0.011);
}

TEST(RecursiveLeastSquares, ExponentialFormWindsUpNoFurtherThanItsLimit) {
  Rls::Options options = With(Forgetting::kExponential, 0.99);
  options.max_covariance = 1e6;
  Rls rls = Make(options, 4);
  for (int k = 0; k < 1'000'000; ++k) Take(rls, {VectorXd::Unit(4, 1), 1.0});
  const MatrixXd p = rls.Covariance();
  EXPECT_TRUE(p.allFinite());
  EXPECT_LE(p.diagonal().maxCoeff(), 1e6 / 0.99 * (1 + 1e-12));
  EXPECT_GT(Smallest(p), 0);
}

TEST(RecursiveLeastSquares, RefusesWhatIsNotANumberAndStaysAsItWas) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  Rls rls = Make(With(Forgetting::kDirectional, 0.99), 3);
  RandomStream random(7);
  for (int k = 0; k < 50; ++k) Take(rls, Draw(random, Truth(3)));
  const auto before = rls.Save();
  for (double bad : {kNan, kInf, -kInf, 1e200}) {
    for (int i = 0; i < 3; ++i) {
      VectorXd u = VectorXd::Ones(3);
      u[i] = bad;
      EXPECT_EQ(Take(rls, {u, 1.0}), UpdateOutcome::kNotFinite) << bad << " in regressor " << i;
    }
    if (!std::isfinite(bad)) {
      EXPECT_EQ(Take(rls, {VectorXd::Ones(3), bad}), UpdateOutcome::kNotFinite) << bad;
    }
  }
  const auto after = rls.Save();
  EXPECT_EQ(std::memcmp(&before, &after, sizeof before), 0);
}

TEST(RecursiveLeastSquares, AbsurdlyLargeRegressorsDoNotDestroyTheCovariance) {
  Rls rls = Make(With(Forgetting::kDirectional, 0.99), 3);
  for (double size : {1e20, 1e60, 1e120, 1e150, 1e153}) Take(rls, {size * Eigen::Vector3d(1, 2, -1), 1.0});
  RandomStream random(8);
  for (int k = 0; k < 2000; ++k) Take(rls, Draw(random, Truth(3)));
  EXPECT_TRUE(rls.theta().allFinite());
  EXPECT_TRUE(rls.Covariance().allFinite());
}

TEST(RecursiveLeastSquares, AnEquationWithoutRegressorChangesNothing) {
  Rls rls = Make(With(Forgetting::kExponential, 0.9), 2);
  const auto before = rls.Save();
  EXPECT_EQ(Take(rls, {VectorXd::Zero(2), 5.0}), UpdateOutcome::kNoExcitation);
  EXPECT_EQ(Take(rls, {VectorXd::Constant(2, 1e-7), 5.0}), UpdateOutcome::kNoExcitation);
  const auto after = rls.Save();
  EXPECT_EQ(std::memcmp(&before, &after, sizeof before), 0);
  EXPECT_EQ(rls.innovation(), 5.0 - 2e-7);
}

TEST(RecursiveLeastSquares, InnovationsWithinTheDeadZoneAreIgnored) {
  Rls::Options options = With(Forgetting::kDirectional, 0.99);
  options.dead_zone = 2.0;
  Rls rls = Make(options, 2);
  rls.set_noise_scale(3.0);
  const auto before = rls.Save();
  const Eigen::Vector2d u(1, 1);
  EXPECT_EQ(Take(rls, {u, 2 + 5.9}), UpdateOutcome::kInDeadZone);  // prediction 2, zone 2 * 3
  EXPECT_EQ(Take(rls, {u, 2 - 5.9}), UpdateOutcome::kInDeadZone);
  const auto after = rls.Save();
  EXPECT_EQ(std::memcmp(&before, &after, sizeof before), 0);
  EXPECT_EQ(Take(rls, {u, 2 + 6.1}), UpdateOutcome::kUpdated);
}

TEST(RecursiveLeastSquares, AnOutlierCountsNoMoreThanTheClipAllows) {
  Rls::Options options = With(Forgetting::kNone, 1.0);
  options.clip = 4.0;
  Rls clipped = Make(options, 2), reference = Make(options, 2);
  RandomStream random(9);
  for (int k = 0; k < 300; ++k) {
    const Equation e = Draw(random, Truth(2));
    Take(clipped, e);
    Take(reference, e);
  }
  const VectorXd u = Eigen::Vector2d(1, -1);
  const double prediction = u.dot(clipped.theta());
  const double limit = 4 * std::sqrt(1 + u.dot(clipped.Covariance() * u));
  EXPECT_EQ(Take(clipped, {u, prediction + 1e6}), UpdateOutcome::kClipped);
  EXPECT_EQ(Take(reference, {u, prediction + limit * (1 - 1e-12)}), UpdateOutcome::kUpdated);
  EXPECT_LT((clipped.theta() - reference.theta()).norm(), 1e-9);
  EXPECT_NEAR(clipped.innovation(), 1e6, 1e-6);  // reported as it was
}

TEST(RecursiveLeastSquares, ContinuesBitForBitFromASavedState) {
  for (Forgetting form : {Forgetting::kNone, Forgetting::kExponential, Forgetting::kDirectional}) {
    Rls::Options options = With(form, 0.995);
    options.clip = 4;
    Rls rls = Make(options, 5);
    RandomStream random(11);
    for (int k = 0; k < 321; ++k) Take(rls, Draw(random, Truth(5)));
    rls.set_noise_scale(1.25);
    Rls other = Make(options, 5, -3.0);
    other.Restore(rls.Save());
    for (int k = 0; k < 321; ++k) {
      const Equation e = Draw(random, Truth(5));
      EXPECT_EQ(Take(rls, e), Take(other, e));
    }
    const auto a = rls.Save(), b = other.Save();
    EXPECT_EQ(std::memcmp(&a, &b, sizeof a), 0);
    EXPECT_EQ(rls.innovation(), other.innovation());
  }
}

TEST(RecursiveLeastSquares, CovarianceIsSymmetricAndPositiveWithNearlyDependentRegressors) {
  for (Forgetting form : {Forgetting::kNone, Forgetting::kExponential, Forgetting::kDirectional}) {
    Rls rls = Make(With(form, 0.99), 4);
    RandomStream random(12);
    for (int k = 0; k < 20'000; ++k) {
      const double a = random.Normal(), b = random.Normal();
      Take(rls, {Eigen::Vector4d(a, a + 1e-7 * random.Normal(), b, b + 1e-7 * random.Normal()), a + b});
      if (k % 1000 != 0) continue;
      const MatrixXd p = rls.Covariance();
      EXPECT_EQ((p - p.transpose()).cwiseAbs().maxCoeff(), 0.0);
      const VectorXd scale = p.diagonal().cwiseSqrt().cwiseInverse();
      EXPECT_GT(p.diagonal().minCoeff(), 0);
      EXPECT_GT(Smallest(scale.asDiagonal() * p * scale.asDiagonal()), -1e-12);
    }
    EXPECT_NEAR(rls.theta().sum(), 2.0, 1e-3);
  }
}

TEST(RecursiveLeastSquares, WrongOptionsAreNamedWithValueAndLimit) {
  const auto message = [](auto change, int parameters = 4) {
    Rls::Options options;
    change(options);
    return options.Validate(parameters);
  };
  EXPECT_EQ(message([](auto&) {}), "");
  EXPECT_THAT(message([](auto&) {}, 13), testing::HasSubstr("13 parameters, expected 1 to 12"));
  EXPECT_THAT(message([](auto& o) { o.forgetting_factor = 1.5; }),
              testing::HasSubstr("forgetting_factor is 1.5"));
  EXPECT_THAT(message([](auto& o) { o.forgetting_factor = 0; }), testing::HasSubstr("above 0 and at most 1"));
  EXPECT_THAT(message([](auto& o) { o.factors[2] = -0.1; }), testing::HasSubstr("factors[2] is -0.1"));
  EXPECT_THAT(message([](auto& o) { o.initial_covariance = 0; }),
              testing::HasSubstr("initial_covariance is 0"));
  EXPECT_THAT(message([](auto& o) { o.max_covariance = 1; }),
              testing::HasSubstr("at least initial_covariance"));
  EXPECT_THAT(message([](auto& o) { o.dead_zone = -1; }), testing::HasSubstr("dead_zone is -1"));
  EXPECT_THAT(message([](auto& o) { o.clip = std::nan(""); }), testing::HasSubstr("clip is nan"));
}

}  // namespace
}  // namespace hydroscope
