#include "service/live/inbox.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

SampleBatch Batch(std::uint64_t sequence) {
  return {.first_sequence = sequence,
          .requested = {},
          .received = {},
          .channels = {0},
          .rows = 10,
          .values = std::vector<double>(10)};
}

TEST(Inbox, GivesOutWhatCameInItsOrder) {
  Inbox inbox(1000);
  for (std::uint64_t k = 0; k < 5; ++k) inbox.Push(static_cast<int>(k), Batch(k));
  const auto entries = inbox.TakeAll(1);
  ASSERT_EQ(entries.size(), 5u);
  EXPECT_EQ(entries[3].source, 3);
  EXPECT_TRUE(inbox.TakeAll(0).empty());
}

TEST(Inbox, WhenFullTheOlderHalfGoesAtOnceSoThatTheRestIsOnePiece) {
  Inbox inbox(1000);
  for (std::uint64_t k = 0; k < 250; ++k) inbox.Push(0, Batch(k));
  const auto entries = inbox.TakeAll(0);
  EXPECT_GE(entries.size(), 50u);
  for (std::size_t i = 1; i < entries.size(); ++i)
    EXPECT_EQ(entries[i].batch.first_sequence, entries[i - 1].batch.first_sequence + 1);
  EXPECT_EQ(entries.back().batch.first_sequence, 249u);
  EXPECT_EQ(inbox.counters().dropped_batches, 250 - static_cast<std::int64_t>(entries.size()));
  EXPECT_EQ(inbox.counters().dropped_values, 10 * inbox.counters().dropped_batches);
}

}  // namespace
}  // namespace hydroscope
