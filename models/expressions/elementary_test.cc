#include "models/expressions/elementary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace hydroscope {
namespace {

constexpr double kTolerance = 4e-16;

TEST(Elementary, ExponentialAgreesWithTheLibraryOverItsWholeRange) {
  std::mt19937_64 random(1);
  for (const double range : {1e-6, 1.0, 40.0, 708.0}) {
    std::uniform_real_distribution<double> argument(-range, range);
    for (int k = 0; k < 200000; ++k) {
      const double x = argument(random), exact = std::exp(x);
      ASSERT_NEAR(Exp(x), exact, kTolerance * exact) << x;
    }
  }
}

TEST(Elementary, LogarithmAgreesWithTheLibraryOverItsWholeRange) {
  std::mt19937_64 random(2);
  for (const double range : {1e-6, 1e-2, 1.0, 300.0}) {
    std::uniform_real_distribution<double> exponent(-range, range);
    for (int k = 0; k < 200000; ++k) {
      const double x = std::pow(10.0, exponent(random)), exact = std::log(x);
      ASSERT_NEAR(Log(x), exact, kTolerance * std::abs(exact)) << x;
    }
  }
}

TEST(Elementary, HyperbolicTangentAgreesWithTheLibraryOverItsWholeRange) {
  std::mt19937_64 random(3);
  for (const double range : {1e-300, 1e-9, 1e-3, 0.3, 1.0, 25.0, 1e6}) {
    std::uniform_real_distribution<double> argument(-range, range);
    for (int k = 0; k < 200000; ++k) {
      const double x = argument(random), exact = std::tanh(x);
      ASSERT_NEAR(Tanh(x), exact, 1.5 * kTolerance * std::abs(exact)) << x;
    }
  }
}

TEST(Elementary, OneAndZeroAreExact) {
  EXPECT_EQ(Exp(0.0), 1.0);
  EXPECT_EQ(Log(1.0), 0.0);
  EXPECT_EQ(Tanh(0.0), 0.0);
  EXPECT_EQ(Tanh(1e300), 1.0);
  EXPECT_EQ(Tanh(-std::numeric_limits<double>::infinity()), -1.0);
}

TEST(Elementary, ArgumentsBeyondTheRangeStayFinite) {
  EXPECT_EQ(Exp(-1e9), Exp(-708.0));
  EXPECT_EQ(Exp(1e9), Exp(709.0));
  EXPECT_TRUE(std::isfinite(Exp(709.0)));
}

TEST(Elementary, NotANumberStaysNotANumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(Exp(nan)));
  EXPECT_TRUE(std::isnan(Log(nan)));
  EXPECT_TRUE(std::isnan(Tanh(nan)));
}

}  // namespace
}  // namespace hydroscope
