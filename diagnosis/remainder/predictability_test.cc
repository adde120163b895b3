#include "diagnosis/remainder/predictability.h"

#include <gtest/gtest.h>

#include <array>

#include "diagnosis/explain.h"
#include "diagnosis/simulated_log_fixture.h"

namespace hydroscope {
namespace {

PressOptions Press(std::uint64_t seed) {
  PressOptions options;
  options.seconds = 90;
  options.seed = seed;
  return options;
}

/// What an analogue filter or a PLC makes of white noise, instead of it.
ImperfectionSetting ColouredNoise(double phi) {
  return {"coloured_noise", 0.1, {{"phi", phi}, {"white", 0}}, {}};
}

Predictability OfBase(const SimulatedStrokes& log) {
  const ExtendedFit base = log.Fit();
  const std::array<const ExtendedFit*, 1> fits = {&base};
  return PredictabilityOf(*log.model, log.strokes, log.window, fits).front();
}

TEST(Predictability, FindsNothingInNoiseOfAnyColour) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
    for (const double phi : {0.0, 0.8, 0.95}) {
      PressOptions options = Press(seed);
      if (phi > 0) options.imperfections = {ColouredNoise(phi)};
      const Predictability left = OfBase(StrokesOfPress(options));
      ASSERT_TRUE(left.tested);
      EXPECT_FALSE(left.IsStructured({})) << seed << " " << phi << ": " << left.about << " " << left.share;
    }
}

/// Where the pressure stands still, a softer oil column takes the sensor's noise out of the balance, and features that are of no use
/// elsewhere let it be soft there.
TEST(Predictability, FindsNothingInNoiseThatFeaturesShareWithTheBalance) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    PressOptions options = Press(seed);
    options.noise.p_A = 2.5e5;
    options.noise.z = 2e-5;
    options.motion.speed_max = 0.04;
    options.imperfections = {{"calm_pressure", 5, {}, ""}};
    const Predictability left = OfBase(StrokesOfPress(options));
    ASSERT_TRUE(left.tested);
    EXPECT_FALSE(left.IsStructured({})) << seed << ": " << left.about << " " << left.share;
  }
}

TEST(Predictability, FindsWhatAMissingLawLeavesAndWhatItGoesWith) {
  PressOptions options = Press(5);
  options.effects = {{"relief_valve", 2e-11, {{"crack", 150e5}}}};
  options.imperfections = {ColouredNoise(0.8)};
  const Predictability left = OfBase(StrokesOfPress(options));
  EXPECT_TRUE(left.IsStructured({}));
  EXPECT_LE(left.p_value, 0.01);
  EXPECT_EQ(left.about, "p_A");
}

TEST(Predictability, WhatCannotBePredictedIsTheNoise) {
  PressOptions options = Press(6);
  const SimulatedStrokes healthy = StrokesOfPress(options);
  options.effects = {{"internal_leakage", 4e-12, {}}};
  const double noise = OfBase(healthy).left(), beside_leak = OfBase(StrokesOfPress(options)).left();
  EXPECT_NEAR(noise / healthy.Fit().noise_variance, 1.0, 0.1);
  EXPECT_NEAR(beside_leak / noise, 1.0, 0.35);  // of an error several times the noise little is left
}

TEST(ExplainSamples, WithoutABelievableFloorNamesTheEffectUnderColouredNoise) {
  PressOptions options = Press(7);
  options.imperfections = {ColouredNoise(0.8)};
  ExplainOptions explain;
  explain.floor_believable = explain.noise_is_white = false;
  const SimulatedStrokes healthy = StrokesOfPress(options);
  const Explanation nothing = ExplainSamples(healthy.model, healthy.strokes, healthy.window, explain);
  EXPECT_EQ(nothing.verdict, Verdict::kAdequate);
  EXPECT_GT(nothing.noise_scale, 10);  // white noise of its highest frequencies would be so much less
  options.effects = {{"internal_leakage", 4e-12, {}}};
  const SimulatedStrokes leaking = StrokesOfPress(options);
  const Explanation leak = ExplainSamples(leaking.model, leaking.strokes, leaking.window, explain);
  ASSERT_FALSE(leak.set.empty());  // with or without the leak to outside, which is nearly the same here
  EXPECT_EQ(leak.set.front(), "internal_leakage");
}

}  // namespace
}  // namespace hydroscope
