#include "workbench/explain/located_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hydroscope {
namespace {

TEST(LocatedText, SmallErrorsDoNotReadAsZero) {
  const Located where = {"x", 0, 10, "mm", 3.4e-4, -1.2e-5, 0.6, 0.2};
  const std::string text = LocatedText({where}, {1, 0, "V"}, "");
  EXPECT_THAT(text, testing::AllOf(testing::HasSubstr("(V, "), testing::HasSubstr("0.00034"),
                                   testing::HasSubstr("-1.2e-5")));
}

}  // namespace
}  // namespace hydroscope
