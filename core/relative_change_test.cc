#include "core/relative_change.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

TEST(RelativeChange, IsAShareOfTheValueBefore) {
  EXPECT_DOUBLE_EQ(RelativeChange(1.2e9, 1e7, -1.2e8).value(), -0.1);
  EXPECT_DOUBLE_EQ(RelativeChange(-2, 0, 1).value(), 0.5) << "of its size: the sign is that of the change";
}

TEST(RelativeChange, IsNotToldOfAValueNearZero) {
  EXPECT_FALSE(RelativeChange(0, 0, 1));
  EXPECT_FALSE(RelativeChange(1e-15, 0, 2e-12)) << "+197223 %";
  EXPECT_FALSE(RelativeChange(0.8e-2, 0.3e-2, -1.4e-2)) << "the value itself is not clear of zero";
  EXPECT_FALSE(RelativeChange(std::nan(""), 0, 1));
}

}  // namespace
}  // namespace hydroscope
