#include "replay/decimal.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

namespace hydroscope {
namespace {

/// Reads `number` as a field of a row; NaN if it is no number or something is left over.
double Read(std::string number, char point = '.', bool general = false) {
  const std::size_t size = number.size();
  number += ",";
  number.resize(number.size() + kDecimalPadding, '7');
  double value = 0;
  const char* end =
      general ? ParseDecimalGeneral(number.data(), point, value) : ParseDecimal(number.data(), point, value);
  if (!general && end != nullptr && *end == 'e') end = ParseDecimalGeneral(number.data(), point, value);
  return end == number.data() + size ? value : std::nan("");
}

bool SameBits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

TEST(Decimal, ReadsEveryFormatToTheSameBitsAsStrtod) {
  std::mt19937_64 random(1);
  const char* formats[] = {"{:.0f}", "{:.1f}",  "{:.3f}",  "{:.7f}", "{:.9f}",
                           "{:.4e}", "{:.16e}", "{:.17g}", "{:.6g}", "{}"};
  std::uniform_real_distribution<double> exponent(-9, 12);
  for (int i = 0; i < 10000; ++i)
    for (const char* format : formats) {
      const double sign = random() % 2 == 0 ? 1 : -1;
      const std::string text = fmt::format(fmt::runtime(format), sign * std::pow(10.0, exponent(random)));
      ASSERT_TRUE(SameBits(Read(text), std::strtod(text.c_str(), nullptr))) << text;
      ASSERT_TRUE(SameBits(Read(text, '.', true), std::strtod(text.c_str(), nullptr))) << text;
    }
}

TEST(Decimal, ReadsAnyDoubleBackFromItsShortestText) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 100000; ++i) {
    const double value = std::bit_cast<double>(random());
    if (!std::isfinite(value)) continue;
    ASSERT_TRUE(SameBits(Read(fmt::format("{}", value)), value)) << fmt::format("{}", value);
  }
}

TEST(Decimal, ReadsEveryNumberOfDigitsOnBothSidesOfThePoint) {
  for (int whole = 0; whole <= 25; ++whole)
    for (int fraction = 0; fraction <= 25; ++fraction) {
      if (whole + fraction == 0) continue;
      const std::string_view digits = "9876543210987654321098765";
      const std::string text = fmt::format("-{}.{}", digits.substr(0, static_cast<std::size_t>(whole)),
                                           digits.substr(0, static_cast<std::size_t>(fraction)));
      ASSERT_TRUE(SameBits(Read(text), std::strtod(text.c_str(), nullptr))) << text;
    }
}

TEST(Decimal, TakesADecimalComma) { EXPECT_EQ(Read("-12,5", ','), -12.5); }
TEST(Decimal, TakesAPlusSign) { EXPECT_EQ(Read("+0.25"), 0.25); }
TEST(Decimal, KeepsTheSignOfZero) { EXPECT_TRUE(std::signbit(Read("-0.0"))); }
TEST(Decimal, OverflowsToInfinity) { EXPECT_TRUE(std::isinf(Read("1e999"))); }
TEST(Decimal, UnderflowsToZero) { EXPECT_EQ(Read("1e-999"), 0.0); }

TEST(Decimal, RefusesWhatIsNoNumber) {
  for (const char* text : {"", "-", ".", "-.", "x", "e5", "1.2.3", "1e", "0x10", "--1", "12a"})
    EXPECT_TRUE(std::isnan(Read(text))) << text;
}

}  // namespace
}  // namespace hydroscope
