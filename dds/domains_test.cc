#include "dds/domains.h"

#include <gtest/gtest.h>

#include <set>

namespace hydroscope {
namespace {

TEST(FreeDomain, IsAnotherOneEachTimeWithPortsBelowThoseOfTheSystem) {
  std::set<int> domains;
  for (int k = 0; k < 8; ++k) domains.insert(FreeDomain());
  EXPECT_EQ(domains.size(), 8u);
  EXPECT_GE(*domains.begin(), 1);
  EXPECT_LE(*domains.rbegin(), 100);
}

}  // namespace
}  // namespace hydroscope
