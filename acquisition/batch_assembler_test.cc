#include "acquisition/batch_assembler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace hydroscope {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class BatchAssemblerTest : public ::testing::Test {
 protected:
  BatchAssemblerTest() : assembler_({"left/p", "", "right/p", "shared", "shared"}) {}

  void Announce(std::vector<std::string> channels = {"x", "shared", "left/p", "right/p"},
                std::uint64_t session = 7) {
    assembler_.Receive(LayoutMessage{kLiveProtocolVersion, session, 1, std::move(channels)}, emit_);
  }
  static BatchMessage Message(std::uint64_t first, std::uint32_t rows) {
    BatchMessage message{kLiveProtocolVersion, 7, 1, first, 1'000'000'000, 1'000'000, rows, {}};
    for (std::uint32_t k = 0; k < 4 * rows; ++k) message.values.push_back(k);
    return message;
  }
  void Receive(BatchMessage message) { assembler_.Receive(std::move(message), {42, 43}, emit_); }

  BatchAssembler assembler_;
  std::vector<SampleBatch> got_;
  std::int64_t now_ = 0;  ///< ns
  BatchAssembler::Emit emit_ = [this](SampleBatch&& batch) { got_.push_back(std::move(batch)); };
};

TEST_F(BatchAssemblerTest, PicksTheWantedColumnsByTheirNames) {
  Announce();
  Receive(Message(100, 2));
  ASSERT_EQ(got_.size(), 1u);
  EXPECT_THAT(got_[0].channels, ElementsAre(0, 2, 3, 4));
  EXPECT_THAT(got_[0].values, ElementsAre(2, 3, 1, 1, 6, 7, 5, 5));
  EXPECT_EQ(got_[0].session, 7u);
  EXPECT_EQ(got_[0].first_sequence, 100u);
  EXPECT_EQ(got_[0].received.monotonic_ns, 42);
  EXPECT_EQ(assembler_.complaint(), "");
}

TEST_F(BatchAssemblerTest, ABatchWaitsForItsLayout) {
  Receive(Message(0, 2));
  EXPECT_THAT(got_, IsEmpty());
  Announce();
  EXPECT_EQ(got_.size(), 1u);
}

TEST_F(BatchAssemblerTest, FarSequenceNumbersDoNotMakeItDeaf) {
  Announce();
  const auto at = [&](std::int64_t ms, std::uint64_t first) {
    assembler_.Receive(Message(first, 10), {ms * 1'000'000, 0}, emit_);
  };
  for (std::uint64_t k = 0; k < 100; ++k) {
    at(static_cast<std::int64_t>(10 * k), 10 * k);
    at(static_cast<std::int64_t>(10 * k), 1'000'000 * (k + 1));  // never twice at the same place
  }
  got_.clear();
  for (std::uint64_t k = 100; k < 200; ++k) at(static_cast<std::int64_t>(10 * k), 10 * k);
  EXPECT_EQ(got_.size(), 100u);
  EXPECT_EQ(got_.back().rows, 10u);
  EXPECT_EQ(assembler_.counters().lost_rows, 0);
  EXPECT_EQ(assembler_.counters().duplicate_rows, 0);
}

TEST_F(BatchAssemblerTest, ACountThatGoesOnElsewhereIsFollowedAfterASecond) {
  Announce();
  for (const std::uint64_t begin : {5'000'000u, 100'000'000u, 1000u}) {
    for (std::uint64_t k = 0; k < 150; ++k) {
      now_ += 10'000'000;
      assembler_.Receive(Message(begin + 10 * k, 10), {now_, 0}, emit_);
    }
    EXPECT_EQ(got_.back().first_sequence, begin + 1490);
    const std::int64_t duplicates = assembler_.counters().duplicate_rows;
    assembler_.Receive(Message(begin + 1490, 10), {now_, 0}, emit_);
    EXPECT_EQ(assembler_.counters().duplicate_rows, duplicates + 10) << "counted from there on";
  }
}

TEST_F(BatchAssemblerTest, ASessionBelongsToTheWriterItCameFrom) {
  Announce();
  Receive(Message(100, 2));
  BatchMessage forged = Message(900'000, 2);
  forged.writer = 66;
  Receive(forged);
  EXPECT_EQ(got_.size(), 1u) << "this writer has announced no layout";
  assembler_.Receive(LayoutMessage{kLiveProtocolVersion, 7, 1, {"left/p", "right/p", "x", "y"}, 66}, emit_);
  ASSERT_EQ(got_.size(), 2u);
  EXPECT_EQ(got_.back().writer, 66u);
  Receive(Message(102, 2));
  EXPECT_THAT(got_.back().values, ElementsAre(2, 3, 1, 1, 6, 7, 5, 5)) << "still with the layout of its own";
  EXPECT_EQ(assembler_.counters().lost_rows, 0);
}

TEST_F(BatchAssemblerTest, InventedSessionsDoNotMakeItForgetALayout) {
  Announce();
  for (std::uint64_t session = 100; session < 300; ++session)
    assembler_.Receive(LayoutMessage{kLiveProtocolVersion, session, 1, {"left/p"}, 66}, emit_);
  Receive(Message(0, 2));
  EXPECT_EQ(got_.size(), 1u);
}

TEST_F(BatchAssemblerTest, BatchesWithoutAnyLayoutAreCountedAndBounded) {
  for (std::uint64_t k = 0; k < 1000; ++k) Receive(Message(k, 1));
  EXPECT_EQ(assembler_.counters().malformed, 1000 - 256);
  EXPECT_THAT(assembler_.complaint(), HasSubstr("layout"));
}

TEST_F(BatchAssemblerTest, AFaultIsForgottenAfterAMinuteOfSoundBatchesAMissingChannelIsNot) {
  Announce({"left/p", "a", "b", "c"});
  BatchMessage bad = Message(0, 1);
  bad.source_time_ns = -1;
  Receive(bad);
  const auto sound = [&](std::int64_t s) {
    assembler_.Receive(Message(static_cast<std::uint64_t>(1000 * s), 1), {s * 1'000'000'000, 0}, emit_);
  };
  for (std::int64_t s = 1; s < 60; ++s) sound(s);
  EXPECT_THAT(assembler_.complaint(), HasSubstr("a time of -1 ns"));
  sound(61);
  EXPECT_THAT(assembler_.complaint(), HasSubstr("right/p"));
}

TEST_F(BatchAssemblerTest, AMissingChannelIsNamedAndTheOthersAreDelivered) {
  Announce({"left/p", "a", "b", "c"});
  Receive(Message(0, 1));
  ASSERT_EQ(got_.size(), 1u);
  EXPECT_THAT(got_[0].channels, ElementsAre(0));
  EXPECT_THAT(assembler_.complaint(), HasSubstr("right/p"));
}

TEST_F(BatchAssemblerTest, ASecondSendersLayoutMakesNoChannelOfTheFirstMissing) {
  const auto send = [&](std::int64_t s, std::uint64_t writer) {
    BatchMessage message = Message(static_cast<std::uint64_t>(1000 * s), 1);
    message.writer = writer;
    assembler_.Receive(std::move(message), {s * 1'000'000'000, 0}, emit_);
  };
  Announce();
  send(1, 0);
  assembler_.Receive(LayoutMessage{kLiveProtocolVersion, 7, 1, {"left/p", "a", "b", "c"}, 66}, emit_);
  send(1, 66);
  send(2, 0);
  EXPECT_EQ(assembler_.complaint(), "");
  for (std::int64_t s = 3; s < 9; ++s) send(s, 66);
  EXPECT_THAT(assembler_.complaint(), HasSubstr("announces 4 channels but not right/p")) << "it is alone now";
}

TEST_F(BatchAssemblerTest, OverlappingRowsAreDeliveredOnce) {
  Announce();
  Receive(Message(0, 4));
  Receive(Message(2, 4));
  ASSERT_EQ(got_.size(), 2u);
  EXPECT_EQ(got_[1].first_sequence, 4u);
  EXPECT_EQ(got_[1].rows, 2u);
  EXPECT_EQ(got_[1].source_time_ns, 1'002'000'000);
  EXPECT_THAT(got_[1].values, ElementsAre(10, 11, 9, 9, 14, 15, 13, 13));
  EXPECT_EQ(assembler_.counters().duplicate_rows, 2);
}

TEST_F(BatchAssemblerTest, SessionsAreCountedEachForItself) {
  Announce();
  Announce({"x", "shared", "left/p", "right/p"}, 8);
  Receive(Message(1000, 1));
  BatchMessage other = Message(0, 1);
  other.session = 8;
  Receive(other);
  Receive(Message(1003, 1));
  EXPECT_EQ(got_.size(), 3u);
  EXPECT_EQ(assembler_.counters().lost_rows, 2);
  EXPECT_EQ(assembler_.counters().duplicate_rows, 0);
}

TEST_F(BatchAssemblerTest, ManySessionsTakeNoMoreMemoryAndLoseNoCount) {
  for (std::uint64_t session = 0; session < 200; ++session) {
    Announce({"x", "shared", "left/p", "right/p"}, session);
    for (const std::uint64_t first : {0, 10}) {
      BatchMessage message = Message(first, 1);
      message.session = session;
      Receive(message);
    }
  }
  EXPECT_EQ(assembler_.counters().lost_rows, 200 * 9);
}

TEST_F(BatchAssemblerTest, WhatCannotBeRightIsCountedAndLeftOut) {
  Announce();
  const auto with = [](auto change) {
    BatchMessage message = Message(0, 2);
    change(message);
    return message;
  };
  const std::vector<BatchMessage> wrong = {
      with([](BatchMessage& m) { m.version = 9; }),
      with([](BatchMessage& m) { m.rows = 0; }),
      with([](BatchMessage& m) { m.rows = 4'000'000'000; }),
      with([](BatchMessage& m) { m.values.pop_back(); }),
      with([](BatchMessage& m) { m.period_ns = -1; }),
      with([](BatchMessage& m) { m.period_ns = 0; }),
      with([](BatchMessage& m) { m.source_time_ns = std::numeric_limits<std::int64_t>::max(); }),
      with([](BatchMessage& m) { m.first_sequence = std::numeric_limits<std::uint64_t>::max(); })};
  for (const BatchMessage& message : wrong) Receive(message);
  EXPECT_THAT(got_, IsEmpty());
  EXPECT_EQ(assembler_.counters().malformed, static_cast<std::int64_t>(wrong.size()));
  Receive(Message(0, 2));
  EXPECT_EQ(got_.size(), 1u) << "a sound batch afterwards is taken";
}

TEST_F(BatchAssemblerTest, ValuesThatAreNoNumbersAreLeftToTheQualityFlags) {
  Announce();
  BatchMessage message = Message(0, 1);
  message.values[2] = NAN;
  Receive(message);
  ASSERT_EQ(got_.size(), 1u);
  EXPECT_TRUE(std::isnan(got_[0].values[0]));
}

}  // namespace
}  // namespace hydroscope
