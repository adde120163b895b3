#include "pipeline/log_faults/aliased_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace hydroscope {
namespace {

Machine Oscillator() {
  Machine machine;
  machine.model = "expressions";
  for (const auto& [name, unit] : {std::pair{"v", "m/s"}, {"x", "m"}}) {
    SignalSpec signal;
    signal.name = name;
    signal.unit = unit;
    machine.signals.push_back(signal);
  }
  machine.balance.terms = {{"m", "ddt(v)", "kg"}, {"k", "x", "N/m"}};
  return machine;
}

ModelStructure Channels() {
  ModelStructure model;
  model.channel_names = {"v", "x"};
  model.channel_source = {0, 1};
  return model;
}

/// A swing of `frequency` Hz in 2 s of rows, its sizes changing, with noise of `noise_v` and `noise_x` of them.
std::optional<AliasedMotion> Found(double frequency, double rows_a_second, double noise_v = 0.01,
                                   double noise_x = 0.01) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<std::vector<Stretch>> strokes;
  const double omega = 2 * std::numbers::pi * frequency;
  for (int s = 0; s < 6; ++s) {
    Stretch stretch;
    stretch.period = 1 / rows_a_second;
    stretch.samples = static_cast<int>(2 * rows_a_second);
    stretch.channel.assign(2, std::vector<double>(static_cast<std::size_t>(stretch.samples)));
    const double phase = normal(random);
    for (int k = 0; k < stretch.samples; ++k) {
      const double angle = omega * k * stretch.period + phase;
      stretch.channel[0][static_cast<std::size_t>(k)] = omega * (std::cos(angle) + noise_v * normal(random));
      stretch.channel[1][static_cast<std::size_t>(k)] = std::sin(angle) + noise_x * normal(random) + 0.3;
    }
    strokes.push_back({stretch});
  }
  return FindAliasedMotion(Oscillator(), Channels(), strokes, 1 / rows_a_second);
}

TEST(AliasedMotion, IsFoundBelowTwoRowsOfASwingOnEitherSideOfTheRowsRate) {
  for (const double frequency : {30.0, 45.0, 55.0, 95.0}) {
    const auto found = Found(frequency, 50);
    ASSERT_TRUE(found) << frequency;
    EXPECT_NEAR(found->frequency_hz, frequency, 0.03 * frequency);
    EXPECT_EQ(found->rate, "v");
    EXPECT_EQ(found->level, "x");
  }
}

TEST(AliasedMotion, IsNotSeenInASwingOfManyRowsNorInNoise) {
  for (const double frequency : {0.7, 3.0, 10.0}) EXPECT_FALSE(Found(frequency, 100)) << frequency;
  EXPECT_FALSE(Found(1, 100, 100, 0.01)) << "a speed that is mostly noise";
  EXPECT_FALSE(Found(1, 100, 1, 100)) << "a position that is mostly noise";
}

}  // namespace
}  // namespace hydroscope
