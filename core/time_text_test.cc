#include "core/time_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <ctime>

namespace hydroscope {
namespace {

TEST(DurationText, ChoosesTheUnitPeopleRead) {
  EXPECT_EQ(DurationText(0.35), "350 ms");
  EXPECT_EQ(DurationText(12.34), "12.3 s");
  EXPECT_EQ(DurationText(600), "10.0 min");
  EXPECT_EQ(DurationText(5 * 3600), "5.0 h");
  EXPECT_EQ(DurationText(10 * 86400), "10.0 days");
}

TEST(DurationText, IsNeverNegative) {
  EXPECT_EQ(DurationText(-3), "0 s");
  EXPECT_EQ(DurationText(NAN), "-");
}

TEST(LocalTimeText, IsInTheTimeZoneOfTheComputer) {
  const char* before = std::getenv("TZ");
  const std::string kept = before ? before : "";
  setenv("TZ", "UTC-2", 1);  // two hours east of Greenwich
  tzset();
  EXPECT_EQ(LocalTimeText(1772373909), "2026-03-01 16:05:09");
  before ? setenv("TZ", kept.c_str(), 1) : unsetenv("TZ");
  tzset();
}

}  // namespace
}  // namespace hydroscope
