#include "acquisition/channel_owners.h"

#include <gmock/gmock.h>

#include <cmath>

namespace hydroscope {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class Owners : public ::testing::Test {
 protected:
  /// A batch of 10 ms of these channels at `at` s; the columns that count.
  std::vector<std::size_t> Hear(std::uint64_t writer, std::uint64_t session, double at,
                                std::vector<std::uint16_t> channels = {0, 1}) {
    const SampleBatch batch{.writer = writer,
                            .session = session,
                            .period_ns = 1'000'000,
                            .requested = {},
                            .received = {std::llround(at * 1e9), 0},
                            .channels = std::move(channels),
                            .rows = 10,
                            .values = {}};
    return owners_.Admit(0, batch);
  }
  int Count(std::size_t channel, double at) const { return owners_.count(channel, std::llround(at * 1e9)); }

  ChannelOwners owners_{4, 0.5};
};

TEST_F(Owners, TheFirstSenderIsBelievedAndTheSecondIsCounted) {
  for (int k = 0; k < 50; ++k) {
    EXPECT_THAT(Hear(1, 7, 0.01 * k), ElementsAre(0, 1)) << k;
    EXPECT_THAT(Hear(2, 9, 0.01 * k + 0.005), IsEmpty()) << k;
  }
  EXPECT_EQ(Count(0, 0.5), 2);
  EXPECT_EQ(Count(2, 0.5), 0);
  const auto senders = owners_.senders(kSecond / 2);
  ASSERT_EQ(senders.size(), 2u);
  EXPECT_EQ(senders[0].id, (SenderId{0, 1, 7}));
  EXPECT_EQ(senders[0].rows, 500);
  EXPECT_THAT(senders[1].refused, ElementsAre(0, 1));
  EXPECT_EQ(senders[1].refused_rows, 500);
}

TEST_F(Owners, TheSecondGoesOnWhenTheFirstHasBeenSilentForLong) {
  Hear(1, 7, 0);
  EXPECT_THAT(Hear(2, 9, 0.49), IsEmpty());
  EXPECT_THAT(Hear(2, 9, 0.51), ElementsAre(0, 1));
  EXPECT_THAT(Hear(1, 7, 0.52), IsEmpty()) << "it lost its place";
}

TEST_F(Owners, AnotherLifeOfASenderThatDiedIsNoSecondSender) {
  Hear(1, 7, 0);
  for (int k = 0; k < 100; ++k) Hear(1, 8, 0.3 + 0.01 * k);
  EXPECT_EQ(Count(0, 1.3), 1);
}

TEST_F(Owners, TheSameSessionOfAnotherWriterIsAnotherSender) {
  Hear(1, 7, 0);
  EXPECT_THAT(Hear(2, 7, 0.01), IsEmpty());
}

TEST_F(Owners, OnlyTheChannelsThatAreTakenAreRefused) {
  Hear(1, 7, 0);
  EXPECT_THAT(Hear(2, 9, 0.01, {1, 2, 3}), ElementsAre(1, 2)) << "columns of channels 2 and 3";
  EXPECT_THAT(owners_.senders(0).back().taken, ElementsAre(2, 3));
}

TEST_F(Owners, ASecondSenderThatFallsSilentIsForgotten) {
  for (int k = 0; k < 50; ++k) Hear(1, 7, 0.01 * k), Hear(2, 9, 0.01 * k);
  for (int k = 50; k < 1000; ++k) Hear(1, 7, 0.01 * k);
  EXPECT_EQ(Count(0, 5), 2);
  EXPECT_EQ(Count(0, 6), 1);
}

TEST_F(Owners, ManyInventedSessionsTakeNobodysPlace) {
  Hear(1, 7, 0);
  for (std::uint64_t session = 100; session < 1000; ++session) EXPECT_THAT(Hear(2, session, 0.01), IsEmpty());
  EXPECT_THAT(Hear(1, 7, 0.02), ElementsAre(0, 1));
}

TEST_F(Owners, EveryChannelMayHaveASenderOfItsOwn) {
  ChannelOwners many(200, 0.5);
  for (int round = 0; round < 3; ++round)
    for (std::uint16_t channel = 0; channel < 200; ++channel) {
      const SampleBatch batch{.writer = 100u + channel,
                              .session = 1,
                              .period_ns = 1'000'000,
                              .requested = {},
                              .received = {round * 10'000'000, 0},
                              .channels = {channel},
                              .rows = 10,
                              .values = {}};
      EXPECT_EQ(many.Admit(0, batch).size(), 1u) << channel;
    }
}

TEST_F(Owners, ASenderOfLongBatchesMayBeSilentForThreeOfThem) {
  SampleBatch batch{.session = 1,
                    .period_ns = kSecond,
                    .requested = {},
                    .received = {0, 0},
                    .channels = {3},
                    .rows = 1,
                    .values = {}};
  owners_.Admit(0, batch);
  EXPECT_THAT(Hear(2, 9, 2.9, {3}), IsEmpty());
  EXPECT_THAT(Hear(2, 9, 3.1, {3}), ElementsAre(0));
}

}  // namespace
}  // namespace hydroscope
