#include "diagnosis/drift/cumulative_sum.h"

#include <gtest/gtest.h>

#include "simulator/random.h"

namespace hydroscope::drift {
namespace {

constexpr DriftSize kSize{0.04, 0.2, false};

TEST(CumulativeSum, StaysQuietOverAMillionHealthyStrokes) {
  CumulativeSum test;
  RandomStream random(1);
  for (int k = 0; k < 1'000'000; ++k) {
    test.Add(k, 0.05 * random.Normal(), 0.05, 0.002, kSize);
    ASSERT_EQ(test.Direction(), 0) << "stroke " << k;
  }
}

TEST(CumulativeSum, FindsAStepAndWhereItBegan) {
  CumulativeSum test;
  RandomStream random(2);
  int found = -1;
  for (int k = 0; k < 400 && found < 0; ++k) {
    test.Add(k, (k < 300 ? 0 : -0.08) + 0.03 * random.Normal(), 0.03, 0.002, kSize);
    if (test.Direction() != 0) found = k;
  }
  EXPECT_EQ(test.Direction(), -1);
  EXPECT_GE(found, 300);
  EXPECT_LE(found, 330);
  EXPECT_NEAR(static_cast<double>(test.last_before()), 299, 10);
}

TEST(CumulativeSum, ForgivesThreeBadStrokes) {
  CumulativeSum test;
  for (int k = 0; k < 50; ++k) test.Add(k, k >= 20 && k < 23 ? 1e6 : 0, 0.05, 0, kSize);
  EXPECT_EQ(test.Direction(), 0);
}

TEST(CumulativeSum, LooksOnlyUpwardsWhereDownwardsCannotBe) {
  CumulativeSum test;
  for (int k = 0; k < 200; ++k) test.Add(k, -1, 0.05, 0, {0.04, 0.2, true});
  EXPECT_EQ(test.Direction(), 0);
}

}  // namespace
}  // namespace hydroscope::drift
