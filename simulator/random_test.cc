#include "simulator/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hydroscope {
namespace {

TEST(RandomStream, GivesTheNumbersOfTheStandardGenerator) {
  // The 10000th output of a default-seeded mt19937_64 is fixed by the C++ standard, [rand.predef].
  RandomStream stream(5489);
  for (int k = 0; k < 9999; ++k) stream.Uniform();
  EXPECT_EQ(stream.Uniform(), static_cast<double>(9981545732273789042u >> 11) * 0x1.0p-53);
}

TEST(RandomStream, NormalNumbersHaveTheMomentsOfTheStandardNormal) {
  RandomStream stream(1);
  constexpr int kCount = 400000;
  double sum[5] = {};
  for (int k = 0; k < kCount; ++k) {
    const double x = stream.Normal();
    for (int power = 1; power <= 4; ++power) sum[power] += std::pow(x, power) / kCount;
  }
  EXPECT_NEAR(sum[1], 0, 0.006);
  EXPECT_NEAR(sum[2], 1, 0.01);
  EXPECT_NEAR(sum[3], 0, 0.03);
  EXPECT_NEAR(sum[4], 3, 0.08);
}

TEST(StreamSeed, DiffersByPurposeAndBySeed) {
  EXPECT_NE(StreamSeed(1, "noise"), StreamSeed(1, "motion"));
  EXPECT_NE(StreamSeed(1, "noise"), StreamSeed(2, "noise"));
  EXPECT_EQ(StreamSeed(7, "noise"), StreamSeed(7, "noise"));
}

}  // namespace
}  // namespace hydroscope
