#include "core/interval_text.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hydroscope {
namespace {

TEST(WithInterval, ShowsTwoDigitsOfTheHalfWidth) {
  EXPECT_EQ(WithInterval(1.2103, 0.0214), "1.210 ± 0.021");
  EXPECT_EQ(WithInterval(12202, 424), "12202 ± 424");
  EXPECT_EQ(WithInterval(3, NAN), "3 ± ?");
  EXPECT_EQ(WithInterval(0, 0), "0 ± 0");
  EXPECT_EQ(WithInterval(-0.3, 11), "0 ± 11");
  EXPECT_EQ(WithInterval(NAN, 11), "nan ± 11");
  EXPECT_EQ(FoundWithInterval(0.059064, 16.6), "0.0591 ± 17");
  EXPECT_EQ(FoundWithInterval(7.31e-6, 0.0011), "7.31e-6 ± 0.0011");
  EXPECT_EQ(FoundWithInterval(1.2103, 0.0214), "1.210 ± 0.021");
  EXPECT_EQ(FoundWithInterval(0, 0.4), "0.00 ± 0.40");
}

TEST(WithInterval, AnIntervalThatIsThereNeverReadsAsZero) {
  EXPECT_EQ(WithInterval(0.012, 2.7e-7), "0.0120000 ± 0.0000003");
  EXPECT_EQ(WithInterval(1017, 0.024), "1017.00 ± 0.02");
  EXPECT_EQ(WithInterval(12202, 0.001), "12202.0 ± 0.001");
}

TEST(ChangeWithInterval, ARiseHasItsSign) {
  EXPECT_EQ(ChangeWithInterval(1.2103, 0.0214), "+1.210 ± 0.021");
  EXPECT_EQ(ChangeWithInterval(-12202, 424), "-12202 ± 424");
  EXPECT_EQ(ChangeWithInterval(0, 1), "0.0 ± 1.0");
}

TEST(WithInterval, SmallAndLargeValuesCarryAnExponent) {
  EXPECT_EQ(WithInterval(4.512e-12, 3.1e-14), "(4.512 ± 0.031)e-12");
  EXPECT_EQ(WithInterval(-2e-7, 5e-7), "(-2.0 ± 5.0)e-7");
  EXPECT_EQ(WithInterval(1.21e9, 1.2e7), "(1.210 ± 0.012)e9");
}

TEST(DigitsFor, TellTheEndsOfANarrowIntervalApart) {
  EXPECT_EQ(DigitsFor(1017, 0.024), 7);
  EXPECT_EQ(DigitsFor(1017, 24), 5);
  EXPECT_EQ(DigitsFor(1017, 1e-9), 9);
  EXPECT_EQ(DigitsFor(0, 1), 5);
}

}  // namespace
}  // namespace hydroscope
