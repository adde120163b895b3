#include "core/result.h"

#include <gtest/gtest.h>

#include <memory>

namespace hydroscope {
namespace {

Result<std::unique_ptr<int>> Made(int number) {
  if (number < 0) return BadInput("{} is below 0", number);
  return std::make_unique<int>(number);
}
Status Checked(int number) {
  TRY(Made(number));
  if (number > 9) return BadInput("{} is above 9", number);
  return {};
}
Result<int> Next(int number) {
  TRY(Checked(number));
  const auto made = TRY(Made(number));
  return *made + 1;
}
Result<std::string> Twice(const Result<std::string>& text) {
  const std::string once = TRY(text);
  return once + once;
}

TEST(Try, TakesTheValueOrReturnsTheError) {
  EXPECT_EQ(Next(3), 4);
  const auto below = Next(-1), above = Next(10);
  ASSERT_FALSE(below);
  EXPECT_EQ(below.error().text, "-1 is below 0");
  EXPECT_EQ(below.error().kind, ErrorKind::kBadInput);
  ASSERT_FALSE(above);
  EXPECT_EQ(above.error().text, "10 is above 9");
}

TEST(Try, LeavesANamedResultAsItIs) {
  const Result<std::string> text = "ab";
  EXPECT_EQ(Twice(text), "abab");
  EXPECT_EQ(text, "ab");
}

}  // namespace
}  // namespace hydroscope
