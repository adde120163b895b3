#include "models/smooth_rate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace hydroscope {
namespace {

constexpr double kPeriod = 0.002;
constexpr int kSamples = 200, kHalf = 10;

template <typename Signal>
std::vector<double> Sampled(Signal signal) {
  std::vector<double> x(kSamples);
  for (int k = 0; k < kSamples; ++k) x[k] = signal(k * kPeriod);
  return x;
}

std::vector<double> SharpRateOf(const std::vector<double>& x, int half = kHalf) {
  std::vector<double> rate(x.size());
  SharpRate(x.data(), static_cast<int>(x.size()), half, kPeriod, rate.data());
  return rate;
}

std::vector<double> SmoothRateOf(const std::vector<double>& x, Ends ends) {
  std::vector<double> rate(x.size());
  SmoothRate(x.data(), static_cast<int>(x.size()), kHalf, kPeriod, ends, rate.data());
  return rate;
}

TEST(SmoothRate, IsExactForAParabolaAndAtItsEndsToo) {
  const auto rate = SmoothRateOf(Sampled([](double t) { return 3 - 2 * t + 5 * t * t; }), Ends::kExtend);
  for (int k = 0; k < kSamples; ++k) EXPECT_NEAR(rate[k], -2 + 10 * k * kPeriod, 1e-9) << k;
}

TEST(SmoothRate, HoldsTheNearestFullWindowAtTheEnds) {
  const auto rate = SmoothRateOf(Sampled([](double t) { return t * t; }), Ends::kHold);
  EXPECT_EQ(rate.front(), rate[kHalf]);
  EXPECT_EQ(rate.back(), rate[kSamples - 1 - kHalf]);
}

TEST(SharpRate, IsExactForACubicAwayFromTheEnds) {
  const auto rate = SharpRateOf(Sampled([](double t) { return 1 + t - 4 * t * t + 50 * t * t * t; }));
  for (int k = 2 * kHalf; k < kSamples - 2 * kHalf; ++k) {
    const double t = k * kPeriod;
    EXPECT_NEAR(rate[k], 1 - 8 * t + 150 * t * t, 1e-8) << k;
  }
  EXPECT_EQ(rate.front(), rate[2 * kHalf]);
  EXPECT_EQ(rate.back(), rate[kSamples - 1 - 2 * kHalf]);
}

TEST(SharpRate, SmearsAnOscillationFarLessThanThePlainWindow) {
  const double omega = 2 * std::numbers::pi * 6;
  const auto x = Sampled([=](double t) { return std::sin(omega * t); });
  const auto sharp = SharpRateOf(x), smooth = SmoothRateOf(x, Ends::kHold);
  double sharp_error = 0, smooth_error = 0;
  for (int k = 2 * kHalf; k < kSamples - 2 * kHalf; ++k) {
    const double exact = omega * std::cos(omega * k * kPeriod);
    sharp_error = std::max(sharp_error, std::abs(sharp[k] - exact));
    smooth_error = std::max(smooth_error, std::abs(smooth[k] - exact));
  }
  EXPECT_GT(smooth_error, 0.03 * omega);
  EXPECT_LT(sharp_error, 0.01 * omega);
}

TEST(SharpRate, OfFewSamplesIsFiniteAndOfALineExact) {
  for (int n = 1; n < 50; ++n) {
    std::vector<double> line(n), rate(n, std::nan(""));
    for (int k = 0; k < n; ++k) line[k] = 7 * k * kPeriod;
    SharpRate(line.data(), n, kHalf, kPeriod, rate.data());
    for (const double r : rate) EXPECT_NEAR(r, n < 3 ? 0 : 7, 1e-9) << n;
  }
}

TEST(WhiteNoiseVariance, IsThatOfTheNoiseOnASmoothSignal) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, 0.3);
  const auto x = Sampled([&](double t) { return std::sin(10 * t) + noise(random); });
  EXPECT_NEAR(WhiteNoiseVariance(x.data(), kSamples), 0.09, 0.04);
}

/// Motion of standard deviation 1 about a jump: white noise through a first-order filter, as a valve under a controller.
std::vector<double> FilteredMotion(double pole) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  double state = 0;
  return Sampled([&](double t) {
    state = pole * state + std::sqrt(1 - pole * pole) * normal(random);
    return state + (t > 0.1 ? 20 : 0);
  });
}

TEST(WhitePartVariance, IsThatOfTheNoiseWhereTheSignalJumps) {
  constexpr int kLogs = 300;
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, 0.3);
  double mean = 0;
  for (int log = 0; log < kLogs; ++log)
    mean += WhitePartVariance(Sampled([&](double t) { return (t > 0.1 ? 20 : 0) + noise(random); }).data(),
                              kSamples);
  EXPECT_NEAR(mean / kLogs, 0.09, 0.006);
}

TEST(WhitePartVariance, LeavesOutWhatMovesFromRowToRow) {
  const auto x = FilteredMotion(0.95);
  EXPECT_LT(WhitePartVariance(x.data(), kSamples), 0.3 * WhiteNoiseVariance(x.data(), kSamples));
  EXPECT_EQ(WhitePartVariance(x.data(), 15), 0.0);
}

}  // namespace
}  // namespace hydroscope
