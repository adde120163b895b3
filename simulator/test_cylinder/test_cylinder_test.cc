#include "simulator/test_cylinder/test_cylinder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "simulator/test_cylinder/plant.h"

namespace hydroscope {
namespace {

double Rms(const std::vector<double>& values) {
  double squares = 0;
  for (const double v : values) squares += v * v;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

/// Amplitude of the position over that of a sine of the current, measured over ten periods after twenty.
double GainOfSine(const TestCylinderOptions& o, double hz) {
  TestCylinderPlant plant(o);
  const int steps = 200;
  double sine = 0, cosine = 0;
  for (int k = 0; k < 30 * steps; ++k) {
    const double phase = kTwoPi * (k % steps) / steps;
    if (k >= 20 * steps)
      sine += plant.position() * std::sin(phase), cosine += plant.position() * std::cos(phase);
    plant.Advance(1e-3 * std::sin(kTwoPi * ((k % steps) + 0.5) / steps), 1 / (hz * steps));
  }
  return std::hypot(sine, cosine) * 2 / (10 * steps) / 1e-3;
}

TEST(TestCylinder, ThePlantAnswersSinesAsThePublishedTransferFunction) {
  const TestCylinderOptions o;
  for (const double f : {100.0, 343.0}) {
    const double r = f / o.f_h;
    const double truth =
        o.K_sv / o.area / (kTwoPi * f) / std::hypot(1 - r * r, 2 * o.zeta_h * r) / std::hypot(1, f / o.f_sv);
    EXPECT_NEAR(GainOfSine(o, f) / truth, 1, 2e-3) << f;
  }
}

TEST(TestCylinder, TheExcitationHasTheCurrentAskedForAndTheSeedDecidesIt) {
  const TestCylinderOptions o{.seconds = 20};
  const TestCylinderLog log = SimulateTestCylinder(o);
  EXPECT_NEAR(Rms(log.I_v), 8.9e-3, 0.05 * 8.9e-3);
  EXPECT_EQ(SimulateTestCylinder(o).z, log.z);
  TestCylinderOptions other = o;
  other.seed = 2;
  EXPECT_NE(SimulateTestCylinder(other).z, log.z);
}

TEST(TestCylinder, EffectsMoveTheTruthAsPhysicsSays) {
  TestCylinderOptions o;
  EXPECT_NEAR(TruthOf(o).f_h, 343, 1e-9);
  EXPECT_NEAR(TruthOf(o).zeta_h, 0.9766, 1e-9);
  o.trapped_air = 0.003;
  EXPECT_LT(TruthOf(o).f_h, 335);
  EXPECT_GT(TruthOf(o).zeta_h, 0.99);
  EXPECT_NEAR(TruthOf(o).K_sv, 0.0114, 1e-12);
  o.trapped_air = 0;
  o.specimen = 1e7;
  EXPECT_GT(TruthOf(o).f_h, 380);
  EXPECT_LT(TruthOf(o).K_sv, 0.009);
  o.specimen = 0;
  o.leakage = 32e-12;
  EXPECT_GT(TruthOf(o).f_h, 400);
  EXPECT_LT(TruthOf(o).K_sv, 0.008);
  EXPECT_LT(TruthOf(o).zeta_h, 0.93);
}

TEST(TestCylinder, OptionsOutsideWhatCanBeAreRefusedByName) {
  EXPECT_THAT(Validate(TestCylinderOptions{.f_h = -1}).error().text,
              testing::HasSubstr("f_h is -1 Hz; it must lie between 20 and 1000 Hz"));
  EXPECT_FALSE(Validate(TestCylinderOptions{.seconds = 0}));
  EXPECT_TRUE(Validate(TestCylinderOptions{}));
}

}  // namespace
}  // namespace hydroscope
