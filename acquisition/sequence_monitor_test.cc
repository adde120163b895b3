#include "acquisition/sequence_monitor.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

TEST(SequenceMonitor, BeginsWhereTheFirstBatchBegins) {
  SequenceMonitor monitor;
  EXPECT_EQ(monitor.Receive(1000, 10).missing, 0u);
  EXPECT_EQ(monitor.Receive(1010, 10).missing, 0u);
  EXPECT_EQ(monitor.lost(), 0);
}

TEST(SequenceMonitor, CountsWhatIsMissing) {
  SequenceMonitor monitor;
  monitor.Receive(0, 10);
  EXPECT_EQ(monitor.Receive(25, 5).missing, 15u);
  EXPECT_EQ(monitor.lost(), 15);
}

TEST(SequenceMonitor, WhatComesTwiceIsSkipped) {
  SequenceMonitor monitor;
  monitor.Receive(0, 10);
  EXPECT_EQ(monitor.Receive(0, 10).skip, 10u);
  EXPECT_EQ(monitor.Receive(5, 10).skip, 5u) << "the second half is new";
  EXPECT_EQ(monitor.duplicates(), 15);
  EXPECT_EQ(monitor.Receive(15, 5).missing, 0u);
}

TEST(SequenceMonitor, WhatComesLateIsNoLongerLost) {
  SequenceMonitor monitor;
  monitor.Receive(0, 10);
  monitor.Receive(30, 10);
  const auto late = monitor.Receive(10, 10);
  EXPECT_TRUE(late.reordered);
  EXPECT_EQ(late.skip, 0u);
  EXPECT_EQ(monitor.lost(), 10);
  EXPECT_EQ(monitor.reordered(), 1);
  EXPECT_EQ(monitor.Receive(10, 10).skip, 10u) << "the second time it is a duplicate";
}

TEST(SequenceMonitor, AnotherPieceThatReachesBeyondTheHoleLeavesNoneBehindIt) {
  SequenceMonitor monitor;
  monitor.Receive(0, 10);
  monitor.Receive(20, 10);
  const auto late = monitor.Receive(10, 30);
  EXPECT_TRUE(late.reordered);
  EXPECT_EQ(monitor.lost(), 0);
  EXPECT_EQ(monitor.duplicates(), 10);
  EXPECT_EQ(monitor.Receive(40, 10).missing, 0u) << "rows 30 to 39 came";
}

TEST(SequenceMonitor, ManyHolesTakeNoMoreMemoryAndStillCount) {
  SequenceMonitor monitor;
  for (std::uint64_t k = 0; k < 10000; ++k) monitor.Receive(2 * k, 1);
  EXPECT_EQ(monitor.lost(), 9999);
}

}  // namespace
}  // namespace hydroscope
