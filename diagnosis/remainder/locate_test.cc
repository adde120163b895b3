#include "diagnosis/remainder/locate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "diagnosis/remainder/whiteness.h"

namespace hydroscope {
namespace {

constexpr double kNoise = 1e-5;  // m^3/s

/// Residuals of strokes whose noise is known; `error` is what the model misses at a pressure (Pa) and a
/// position (m).
template <typename Error>
Residuals Made(Error error, int strokes = 12, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Residuals out;
  out.signals = {{"p_A", 0, 1e-5, 0, "bar"}, {"z", 1, 1e3, 0, "mm"}};
  for (int s = 0; s < strokes; ++s) {
    StrokeResiduals stroke;
    constexpr int kWindows = 150;
    stroke.signal.resize(2, kWindows);
    double pressure = 120e5;
    Eigen::VectorXd white(kWindows);
    for (int w = 0; w < kWindows; ++w) {
      pressure = std::clamp(pressure + 15e5 * normal(random), 40e5, 200e5);
      const double z = 0.2 - 0.19 * w / kWindows;
      stroke.signal(0, w) = pressure;
      stroke.signal(1, w) = z;
      const double noise = normal(random);
      white[w] = noise;
      stroke.modelled.push_back(1e-3);
      stroke.measured.push_back(1e-3 + kNoise * noise + error(pressure, z));
      stroke.noise_variance.push_back(kNoise * kNoise);
    }
    stroke.whitened.push_back(white);
    out.strokes.push_back(std::move(stroke));
  }
  return out;
}

double Nothing(double, double) { return 0.0; }

TEST(Locate, AnErrorAboveAPressureIsLocatedThere) {
  const ErrorLocation found = Locate(Made([](double p, double) { return p > 170e5 ? 3e-5 : 0.0; }));
  ASSERT_FALSE(found.located.empty());
  const Located& best = found.located.front();
  EXPECT_EQ(best.signal, "p_A");
  EXPECT_EQ(best.unit, "bar");
  EXPECT_NEAR(best.from, 170, 20);
  EXPECT_NEAR(best.to, 200, 1);
  EXPECT_NEAR(best.rms, 3e-5, 1e-5);
  EXPECT_NEAR(best.mean, 3e-5, 1e-5);
  EXPECT_GT(best.share_error, 0.8);
  EXPECT_EQ(found.single.front().signals, std::vector<int>{0});
  EXPECT_GT(found.single.front().explained, 0.6);
}

TEST(Locate, AnErrorInAZoneOfTheBoreIsLocatedByPosition) {
  const ErrorLocation found =
      Locate(Made([](double, double z) { return std::abs(z - 0.11) < 0.015 ? -3e-5 : 0.0; }));
  ASSERT_FALSE(found.located.empty());
  const Located& best = found.located.front();
  EXPECT_EQ(best.signal, "z");
  EXPECT_LT(best.from, 110);
  EXPECT_GT(best.to, 110);
  EXPECT_LT(best.mean, -1e-5);
}

TEST(Locate, NoiseAloneLocatesNothingInAHundredLogs) {
  int called = 0;
  for (int seed = 1; seed <= 100; ++seed) called += !Locate(Made(Nothing, 12, seed)).located.empty();
  EXPECT_LE(called, 3);
}

TEST(Locate, AFlatErrorLocatesNothing) {
  const ErrorLocation found = Locate(Made([](double, double) { return 2e-5; }));
  EXPECT_GT(found.excess, 4 * found.excess_std);
  EXPECT_TRUE(found.located.empty());
}

TEST(Locate, ThePairThatTheErrorNeedsExplainsMoreThanEither) {
  const ErrorLocation found = Locate(Made([](double p, double z) {
    return p > 120e5 && z > 0.1 ? 4e-5 : p > 120e5 ? -4e-5 : 0.0;
  }));
  ASSERT_FALSE(found.pairs.empty());
  EXPECT_GT(found.pairs.front().explained, found.single.front().explained + 0.3);
}

TEST(Whiteness, NoiseIsWhiteAndASlowErrorIsNot) {
  Residuals noise = Made(Nothing);
  EXPECT_GT(WhitenessOf(noise).p_value, 0.01);
  EXPECT_NEAR(WhitenessOf(noise).variance_ratio, 1.0, 0.1);
  for (StrokeResiduals& stroke : noise.strokes)
    for (Eigen::VectorXd& u : stroke.whitened)
      for (int k = 1; k < u.size(); ++k) u[k] += 0.4 * u[k - 1];
  EXPECT_LT(WhitenessOf(noise).p_value, 1e-6);
  EXPECT_GT(WhitenessOf(noise).autocorrelation.front(), 0.3);
}

TEST(Correlations, AnErrorThatGrowsWithPressureCorrelatesWithPressureAlone) {
  const auto found = CorrelationsOf(Made([](double p, double) { return 1e-12 * (p - 120e5); }));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_LT(found[0].p_value, 1e-4);
  EXPECT_GT(found[0].correlation, 0.2);
  EXPECT_GT(found[1].p_value, 1e-3);
}

TEST(Correlations, AnErrorThatFollowsPressureLaterIsFoundAtItsLag) {
  constexpr int kLate = 3;  // windows
  Residuals late = Made(Nothing);
  for (StrokeResiduals& stroke : late.strokes)
    for (int w = kLate; w < stroke.windows(); ++w)
      stroke.measured[w] += 4e-12 * (stroke.signal(0, w - kLate) - 120e5);
  const auto found = CorrelationsOf(late);
  EXPECT_EQ(found[0].lag, kLate);
  EXPECT_GT(found[0].lagged, found[0].correlation);
  EXPECT_LT(found[0].lagged_p, 1e-4);
}

}  // namespace
}  // namespace hydroscope
