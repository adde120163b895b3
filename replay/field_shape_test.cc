#include "replay/field_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

namespace hydroscope {
namespace {

constexpr char kPadding[] = "                ";

#ifdef HYDROSCOPE_HAS_FIELD_SHAPES
[[gnu::target("avx2")]] bool Read(const std::string& field, const FieldShape& shape, double& value) {
  return ReadShape((field + kPadding).c_str(), shape, value);
}

class FieldShapes : public testing::Test {
 protected:
  void SetUp() override {
    if (!CanReadShapes()) GTEST_SKIP() << "this processor has no AVX2";
  }
};

TEST_F(FieldShapes, GiveTheSameBitsAsStrtodForEveryFieldOfTheShape) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 20000; ++round) {
    const int whole = static_cast<int>(random() % 9), fraction = static_cast<int>(random() % 9);
    const bool negative = random() % 2 == 0;
    const auto field = [&] {
      std::string text = negative ? "-" : "";
      for (int k = 0; k < whole; ++k) text += static_cast<char>('0' + random() % 10);
      if (fraction > 0) text += '.';
      for (int k = 0; k < fraction; ++k) text += static_cast<char>('0' + random() % 10);
      return text;
    };
    const std::string first = field(), next = field();
    FieldShape shape;
    const bool learned = shape.Learn((first + ",").c_str(), std::ssize(first) + 1, '.');
    const bool fits = whole + fraction > 0 && whole + fraction <= 15 && first.size() < 16;
    ASSERT_EQ(learned, fits) << first;
    double value = 0;
    ASSERT_EQ(Read(next + ",", shape, value), fits) << next;
    if (fits) {
      EXPECT_EQ(value, std::strtod(next.c_str(), nullptr)) << next;
      EXPECT_EQ(std::signbit(value), negative);
      EXPECT_EQ(shape.width, std::ssize(first) + 1);
    }
  }
}

TEST_F(FieldShapes, RefuseEveryOtherField) {
  FieldShape shape;
  double value = 0;
  for (const char* field : {"1.25,", "0,", "5", "\xff\xff", ""})
    EXPECT_FALSE(Read(field, shape, value)) << "unknown";
  ASSERT_TRUE(shape.Learn("12.50,", 6, '.'));
  EXPECT_TRUE(Read("99.99,", shape, value));
  for (const char* field : {"12.5,", "12.500,", "-2.50,", "+2.50,", "12,50,", "12.50;", "12.50\n", "1 .50,",
                            "12.5e,", "1e.50,", ".1250,", "125.0,", "\"2.50,", "12.5", ""})
    EXPECT_FALSE(Read(field, shape, value)) << field;
}
#endif

TEST(FieldShape, IsLearnedFromBareNumbersOnly) {
  FieldShape shape;
  for (const char* field :
       {",", ".,", "-,", "+1,", "1e5,", "1.2.3,", " 1,", "1 ,", "nan,", "12", "0.1234567890123456,"}) {
    EXPECT_FALSE(shape.Learn(field, std::ssize(std::string(field)), '.')) << field;
    EXPECT_EQ(shape.width, 0);
  }
}

}  // namespace
}  // namespace hydroscope
