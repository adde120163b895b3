#include "diagnosis/states/other_causes/error_bursts.h"

#include <gtest/gtest.h>

#include <random>

namespace hydroscope {
namespace {

constexpr int kRows = 1000;
constexpr double kPeriod = 4;  // s

Episode Rows() {
  Episode episode;
  episode.signal.resize(kRows, 0);
  for (int row = 0; row < kRows; ++row) episode.time.push_back(kPeriod * row);
  return episode;
}

/// A fit that leaves what noise on a slow process does, `strength` at each row times as much, beside noise of its sensor.
template <typename Strength>
StateFit Leaving(Strength strength, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  StateFit fit;
  fit.noise = Eigen::VectorXd::Ones(1);
  fit.residuals = {RowMatrix(kRows, 1)};
  double slow = 0;
  for (int row = 0; row < kRows; ++row) {
    slow = 0.9 * slow + strength(row) * normal(random);
    fit.residuals[0](row, 0) = slow + 0.3 * normal(random);
  }
  return fit;
}

TEST(ErrorBursts, NoiseOfOneStrengthMakesNone) {
  const Episode episode = Rows();
  for (unsigned seed = 1; seed <= 200; ++seed)
    EXPECT_FALSE(FindErrorBursts(Leaving([](int) { return 1.0; }, seed), std::span(&episode, 1))) << seed;
}

TEST(ErrorBursts, ReadingsThatAreWildOneByOneMakeNone) {
  const Episode episode = Rows();
  std::mt19937 random(3);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    StateFit fit = Leaving([](int) { return 1.0; }, seed);
    for (int k = 0; k < 20; ++k) fit.residuals[0](static_cast<int>(random() % kRows), 0) += 15;
    EXPECT_FALSE(FindErrorBursts(fit, std::span(&episode, 1))) << seed;
  }
}

TEST(ErrorBursts, AreFoundWhereTheyAreThoughReadingsLack) {
  const Episode episode = Rows();
  for (unsigned seed = 1; seed <= 20; ++seed) {
    StateFit fit = Leaving([](int row) { return row >= 400 && row < 440 ? 5.0 : 1.0; }, seed);
    fit.residuals[0].block(600, 0, 100, 1).setConstant(NAN);
    const auto bursts = FindErrorBursts(fit, std::span(&episode, 1));
    ASSERT_TRUE(bursts) << seed;
    EXPECT_GE(bursts->from, kPeriod * 390) << seed;
    EXPECT_LE(bursts->to, kPeriod * 450) << seed;
  }
}

}  // namespace
}  // namespace hydroscope
