#include "core/registers.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace hydroscope {
namespace {

using Words = std::array<std::uint16_t, 4>;

Words Encoded(double value, RegisterType type, WordOrder order) {
  Words words{};
  EncodeRegisters(value, type, order, words);
  return words;
}

TEST(Registers, AFloatLiesInTheOrderItsNameSays) {
  // 123456.0f is 0x47F12000.
  EXPECT_EQ(Encoded(123456, RegisterType::kFloat32, WordOrder::kAbcd), (Words{0x47F1, 0x2000, 0, 0}));
  EXPECT_EQ(Encoded(123456, RegisterType::kFloat32, WordOrder::kCdab), (Words{0x2000, 0x47F1, 0, 0}));
  EXPECT_EQ(Encoded(123456, RegisterType::kFloat32, WordOrder::kBadc), (Words{0xF147, 0x0020, 0, 0}));
  EXPECT_EQ(Encoded(123456, RegisterType::kFloat32, WordOrder::kDcba), (Words{0x0020, 0xF147, 0, 0}));
}

TEST(Registers, EveryTypeReadsBackInEveryOrder) {
  for (std::size_t type = 0; type < kRegisterTypeNames.size(); ++type)
    for (std::size_t order = 0; order < kWordOrderNames.size(); ++order)
      for (const double value : {0.0, 1.0, 77.0, 32000.0}) {
        const auto t = static_cast<RegisterType>(type);
        const auto o = static_cast<WordOrder>(order);
        EXPECT_EQ(DecodeRegisters(Encoded(value, t, o), t, o), value)
            << kRegisterTypeNames[type] << " " << kWordOrderNames[order];
      }
  for (const RegisterType type : {RegisterType::kInt16, RegisterType::kInt32, RegisterType::kInt64})
    EXPECT_EQ(DecodeRegisters(Encoded(-5, type, WordOrder::kCdab), type, WordOrder::kCdab), -5);
}

TEST(Registers, IntegersAreHeldWithinTheirRange) {
  const auto through = [](double value, RegisterType type) {
    return DecodeRegisters(Encoded(value, type, WordOrder::kAbcd), type, WordOrder::kAbcd);
  };
  EXPECT_EQ(through(1e9, RegisterType::kInt16), 32767);
  EXPECT_EQ(through(-1e9, RegisterType::kInt16), -32768);
  EXPECT_EQ(through(-3, RegisterType::kUint32), 0);
  EXPECT_EQ(through(NAN, RegisterType::kInt32), 0);
  EXPECT_EQ(through(1e300, RegisterType::kInt64), std::ldexp(1.0, 63));
}

TEST(Registers, TooFewRegistersAreNoNumber) {
  const Words words{};
  EXPECT_TRUE(
      std::isnan(DecodeRegisters(std::span(words).first(1), RegisterType::kFloat32, WordOrder::kAbcd)));
}

TEST(Registers, WholeNumbersKeepAllTheirBits) {
  Words words{};
  EncodeUnsigned(0x0123456789ABCDEFull, words);
  EXPECT_EQ(words, (Words{0x0123, 0x4567, 0x89AB, 0xCDEF}));
  EXPECT_EQ(DecodeUnsigned(words), 0x0123456789ABCDEFull);
}

}  // namespace
}  // namespace hydroscope
