#include "core/short_number.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hydroscope {
namespace {

TEST(ShortNumber, HasNoExponentWherePeopleReadTheDigits) {
  EXPECT_EQ(ShortNumber(12345.6), "12346");
  EXPECT_EQ(ShortNumber(-632.4, 2), "-632");
  EXPECT_EQ(ShortNumber(999.7), "1000");
  EXPECT_EQ(ShortNumber(0.01234), "0.0123");
  EXPECT_EQ(ShortNumber(0.00012), "0.00012");
  EXPECT_EQ(ShortNumber(0), "0");
}

TEST(ShortNumber, LargeAndSmallOnesCarryTheExponentOfIntervals) {
  EXPECT_EQ(ShortNumber(2.139e7, 4), "2.139e7");
  EXPECT_EQ(ShortNumber(-4.512e-12), "-4.51e-12");
  EXPECT_EQ(ShortNumber(1e9), "1e9");
  EXPECT_EQ(ShortNumber(INFINITY), "inf");
  EXPECT_EQ(ShortNumber(NAN), "nan");
}

}  // namespace
}  // namespace hydroscope
