#include "estimation/floor_trust.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "estimation/noisy_log_fixture.h"

namespace hydroscope {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(FloorTrust, BelievesTheFloorOfWhiteNoise) {
  for (const double scale : {0.1, 1.0, 3.0})
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const FloorTrust trust = LogWith(seed, WhiteNoise, scale).Judge();
      EXPECT_TRUE(trust.believable) << seed << " " << scale << ": " << trust.why;
      EXPECT_THAT(trust.sentences, IsEmpty());
      EXPECT_EQ(trust.noise_scale, 1.0);
    }
}

TEST(FloorTrust, SeesNoiseThatAFilterHasPassed) {
  for (const double phi : {0.3, 0.5, 0.8, 0.95}) {
    const FloorTrust trust = LogWith(1, Filtered(phi), 0.5).Judge();
    EXPECT_FALSE(trust.believable) << phi;
    EXPECT_GT(trust.noise_scale, 1.15) << phi;
    EXPECT_THAT(trust.why, HasSubstr("noise of z is not white")) << phi;
  }
}

TEST(FloorTrust, CountsPositionAndPressureAsTheBalanceDoes) {
  const FloorTrust trust = LogWith(2, WhiteNoise).Judge();
  ASSERT_GE(trust.signals.size(), 2u);
  EXPECT_EQ(trust.signals[0].name, "z");
  EXPECT_EQ(trust.signals[1].name, "p_A");
  EXPECT_NEAR(trust.signals[0].std, 1.2e-4, 4e-6);
  EXPECT_NEAR(trust.signals[1].std, 2.2e5, 7e3);
  double sum = 0;
  for (const SignalNoise& signal : trust.signals) sum += signal.share;
  EXPECT_NEAR(sum, 1, 1e-9);
  // Real motion of the spool is no noise of the balance.
  for (const SignalNoise& signal : trust.signals)
    EXPECT_TRUE(signal.name != "y_v" || signal.share < 0.02) << signal.share;
}

TEST(FloorTrust, HoldsTheContrastsAgainstWhatTheMachineFileStates) {
  JudgedLog log = LogWith(3, WhiteNoise);
  log.Stating("z", 1.2e-4);
  log.Stating("p_A", 2.2e5);
  EXPECT_TRUE(log.Judge().believable);
  log.Stating("z", 3e-5);
  const FloorTrust less = log.Judge();
  EXPECT_FALSE(less.believable);
  EXPECT_EQ(less.signals[0].kind, NoiseKind::kSignalInContrast);
  EXPECT_THAT(less.why, HasSubstr("its stated noise is 0.03 mm"));
  EXPECT_LT(less.noise_scale, 0.5);
  EXPECT_TRUE(less.stated);
  log.Stating("z", 3e-4);
  const FloorTrust more = log.Judge();
  EXPECT_EQ(more.signals[0].kind, NoiseKind::kDisagreesWithStated);
  EXPECT_TRUE(more.believable);  // the readings themselves show their noise
  EXPECT_THAT(more.sentences, SizeIs(1));
}

TEST(FloorTrust, DoesNotTakeAPressureThatMovesFromRowToRowForNoise) {
  const FloorTrust trust = LogWith(4, WhiteNoise, 0.1, 10).Judge();
  ASSERT_GE(trust.signals.size(), 2u);
  const auto pressure = std::find_if(trust.signals.begin(), trust.signals.end(),
                                     [](const SignalNoise& s) { return s.name == "p_A"; });
  ASSERT_NE(pressure, trust.signals.end());
  EXPECT_EQ(pressure->kind, NoiseKind::kSignalInContrast) << pressure->sentence.english;
  EXPECT_FALSE(trust.believable);
}

}  // namespace
}  // namespace hydroscope
