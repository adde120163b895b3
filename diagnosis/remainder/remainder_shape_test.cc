#include "diagnosis/remainder/remainder_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace hydroscope {
namespace {

constexpr double kFlowNoise = 1e-5;  // m^3/s

/// Residuals of strokes whose noise is known; `error` is what the model misses at a pressure (Pa).
template <typename Error>
Residuals OverPressure(Error error, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Residuals out;
  out.signals = {{"p_A", 0, 1e-5, 0, "bar"}, {"z", 1, 1e3, 0, "mm"}};
  for (int s = 0; s < 12; ++s) {
    StrokeResiduals stroke;
    constexpr int kWindows = 150;
    stroke.signal.resize(2, kWindows);
    for (int w = 0; w < kWindows; ++w) {
      const double pressure = 120e5 + 80e5 * std::sin(0.1 * w + s);
      stroke.signal(0, w) = pressure;
      stroke.signal(1, w) = 0.2 - 0.19 * w / kWindows;
      stroke.modelled.push_back(1e-3);
      stroke.measured.push_back(1e-3 + error(pressure) + kFlowNoise * normal(random));
      stroke.noise_variance.push_back(kFlowNoise * kFlowNoise);
    }
    out.strokes.push_back(std::move(stroke));
  }
  return out;
}

double Relief(double pressure) { return -4e-5 * std::max(0.0, pressure - 150e5) / 50e5; }

TEST(RemainderShape, IsTheCurveOfWhatTheModelMissesWithinItsBand) {
  const auto shape = ShapeOfRemainder(OverPressure(Relief));
  ASSERT_TRUE(shape.has_value());
  EXPECT_EQ(shape->signal, "p_A");
  EXPECT_EQ(shape->unit, "bar");
  EXPECT_GT(shape->explained, 0.9);
  for (const ShapePoint& point : shape->points) {
    EXPECT_GT(point.std, 0);
    EXPECT_LT(point.std, 0.5 * kFlowNoise) << point.x;
    EXPECT_NEAR(point.value, Relief(point.x * 1e5), 4 * point.std + 0.2 * kFlowNoise) << point.x;
  }
}

TEST(RemainderShape, NoiseAloneHasNone) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed)
    found += ShapeOfRemainder(OverPressure([](double) { return 0.0; }, seed)).has_value();
  EXPECT_LE(found, 5);
}

TEST(RemainderShape, NeedsThreeStrokes) {
  Residuals residuals = OverPressure(Relief);
  residuals.strokes.resize(2);
  EXPECT_FALSE(ShapeOfRemainder(residuals).has_value());
}

}  // namespace
}  // namespace hydroscope
