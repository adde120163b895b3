#include "live/inbox.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

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

TEST(Inbox, ASenderThatFloodsTakesNothingFromOneThatSendsLittle) {
  constexpr std::uint64_t kFlood = 20'000, kTrickle = 60;  // together below half of the queue
  Inbox inbox(2000);
  std::jthread flood([&] {
    for (std::uint64_t k = 0; k < kFlood; ++k) inbox.Push(0, Batch(k));
  });
  std::jthread trickle([&] {
    for (std::uint64_t k = 0; k < kTrickle; ++k) {
      inbox.Push(1, Batch(k));
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  });
  std::int64_t taken[2] = {0, 0};
  std::uint64_t next[2] = {0, 0};
  while (next[0] < kFlood || next[1] < kTrickle) {
    bool first_of_flood = true;
    for (const Inbox::Entry& entry : inbox.TakeAll(1)) {
      const auto lane = static_cast<std::size_t>(entry.source);
      const std::uint64_t sequence = entry.batch.first_sequence;
      ASSERT_GE(sequence, next[lane]) << "order of a sender";
      // Only between two rounds may something be missing: what waits together is one piece.
      if (lane == 1 || !first_of_flood) {
        ASSERT_EQ(sequence, next[lane]);
      }
      if (lane == 0) first_of_flood = false;
      next[lane] = sequence + 1;
      ++taken[lane];
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));  // too slow for the flood
  }
  const Inbox::Counters counters = inbox.counters();
  EXPECT_EQ(taken[1], static_cast<std::int64_t>(kTrickle));
  EXPECT_GT(counters.dropped_batches, 0);
  EXPECT_EQ(taken[0] + counters.dropped_batches, static_cast<std::int64_t>(kFlood))
      << "nothing goes uncounted";
  ASSERT_EQ(counters.dropped_by_source.size(), 1u);
  EXPECT_EQ(counters.dropped_by_source.at(0), counters.dropped_values);
}

}  // namespace
}  // namespace hydroscope
