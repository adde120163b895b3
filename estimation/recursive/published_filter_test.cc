#include "estimation/recursive/published_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "simulator/random.h"

namespace hydroscope {
namespace {

constexpr double kPeriod = 0.002;

std::vector<double> Noise(int count) {
  RandomStream random(3);
  std::vector<double> x(count);
  for (double& v : x) v = random.Normal();
  return x;
}

/// Eq. 26 of the press paper.
double MovingAverage(const std::vector<double>& x, int k, int half) {
  double sum = 0;
  for (int i = -half; i <= half; ++i) sum += x[k + i];
  return sum / (2 * half + 1);
}

/// Eq. 27 with its 1/T_s, on the averaged signal.
double Derivative(const std::vector<double>& x, int k, int half_average, int half) {
  double sum = 0;
  for (int i = 1; i <= half; ++i)
    sum += MovingAverage(x, k + i, half_average) - MovingAverage(x, k - i, half_average);
  return sum / (half * (half + 1) * kPeriod);
}

TEST(PublishedFilter, EqualsTheFormulasOfThePaper) {
  const std::vector<double> x = Noise(300);
  for (const auto& [average, derivative] :
       std::vector<std::pair<int, int>>{{31, 25}, {5, 5}, {1, 3}, {25, 3}, {1, 51}}) {
    PublishedFilter filter(average, derivative, kPeriod);
    const int half_average = average / 2, half = derivative / 2;
    EXPECT_EQ(filter.Delay(), half_average + half);
    for (int k = 0; k < 300; ++k) {
      const bool ready = filter.Push(x[k]);
      EXPECT_EQ(ready, k >= 2 * filter.Delay()) << k;
      if (!ready) continue;
      const int centre = k - filter.Delay();
      EXPECT_NEAR(filter.value(), MovingAverage(x, centre, half_average), 1e-12);
      EXPECT_NEAR(filter.derivative(), Derivative(x, centre, half_average, half), 1e-9);
    }
  }
}

TEST(PublishedFilter, TheDerivativeOfARampIsItsSlopeAndTheValueItsCentre) {
  PublishedFilter filter(31, 25, kPeriod);
  for (int k = 0; k < 200; ++k) {
    if (!filter.Push(3.0 + 0.05 * k * kPeriod)) continue;
    EXPECT_NEAR(filter.derivative(), 0.05, 1e-12);
    EXPECT_NEAR(filter.value(), 3.0 + 0.05 * (k - filter.Delay()) * kPeriod, 1e-12);
  }
}

TEST(PublishedFilter, WidthZeroIsNoAverageAndAThreePointDerivative) {
  const std::vector<double> x = Noise(20);
  PublishedFilter filter(0, 0, kPeriod);
  EXPECT_EQ(filter.Delay(), 1);
  for (int k = 0; k < 20; ++k) {
    if (!filter.Push(x[k])) continue;
    EXPECT_EQ(filter.value(), x[k - 1]);
    EXPECT_NEAR(filter.derivative(), (x[k] - x[k - 2]) / (2 * kPeriod), 1e-9);
  }
}

TEST(PublishedFilter, EvenWidthsAreMadeOdd) {
  EXPECT_EQ(PublishedFilter(30, 24, kPeriod).Delay(), PublishedFilter(31, 25, kPeriod).Delay());
}

TEST(PublishedFilter, ForgetsEverythingAtAReset) {
  const std::vector<double> x = Noise(100);
  PublishedFilter used(7, 5, kPeriod), fresh(7, 5, kPeriod);
  for (double v : x) used.Push(100 * v);
  used.Reset();
  for (double v : x) {
    const bool ready = fresh.Push(v);
    ASSERT_EQ(used.Push(v), ready);
    if (!ready) continue;
    EXPECT_EQ(used.value(), fresh.value());
    EXPECT_EQ(used.derivative(), fresh.derivative());
  }
}

}  // namespace
}  // namespace hydroscope
