#include <gtest/gtest.h>

#include <cmath>

#include "acquisition/aligner_fixture.h"

namespace hydroscope {
namespace {

TEST(AlignerOfSeveralSenders, OfTwoSendersTheFirstGivesAllItsRows) {
  AlignerBench bench;
  for (std::uint64_t s = 0; s < 2000; s += 10) {
    bench.Stream(s, s + 10);
    SampleBatch other = bench.Rows(s + 500'000, 10);
    other.writer = 2;
    other.session = 8;
    bench.Add(other);
  }
  EXPECT_EQ(bench.Sequences(), Count(0, 2000));
  EXPECT_EQ(bench.counters().second_sender_rows, 2000);
  EXPECT_EQ(bench.counters().sessions, 1);
  EXPECT_EQ(bench.aligner.senders_of(0, bench.now), 2);
}

TEST(AlignerOfSeveralSenders, TheSecondSenderGoesOnWhereTheFirstFellSilent) {
  AlignerBench bench;
  bench.Stream(0, 1000);
  bench.session = 8;
  for (std::uint64_t s = 70'000; s < 72'000; s += 10) {
    bench.now += 10 * kMs;
    bench.aligner.Advance(bench.now);
    bench.Add(bench.Rows(s, 10));
  }
  EXPECT_EQ(bench.Sequences().back(), 71'999);
  EXPECT_EQ(bench.counters().second_sender_rows, 490);
  bench.ExpectTimesIncrease();
}

TEST(AlignerOfSeveralSenders, RowsWithTheSameSessionFromAnotherWriterNeverEnter) {
  AlignerBench bench;
  for (std::uint64_t s = 0; s < 1000; s += 10) {
    bench.Stream(s, s + 10);
    SampleBatch forged = bench.Rows(s + 20, 10);  // a little ahead of the sender
    forged.writer = 2;
    for (double& value : forged.values) value += 1000;
    bench.Add(forged);
  }
  EXPECT_EQ(bench.Sequences(), Count(0, 1000));
  EXPECT_EQ(bench.counters().contradicting_rows, 0);
  EXPECT_EQ(bench.counters().future_rows, 0);
}

TEST(AlignerOfSeveralSenders, ASecondSenderOfSomeChannelsGivesThoseThatNobodyElseSends) {
  AlignerBench bench;
  for (std::uint64_t s = 0; s < 1000; s += 10) {
    bench.Stream(s, s + 10);
    SampleBatch other = bench.Rows(s, 10);
    other.session = 8;
    other.writer = 2;
    other.channels = {1, 2};
    bench.Add(other);
  }
  EXPECT_EQ(bench.Sequences(), Count(0, 1000));
  EXPECT_DOUBLE_EQ(bench.got.signal[1][900], 0.9) << "z of the first sender";
  EXPECT_TRUE(std::isfinite(bench.got.signal[2][900])) << "T_oil of the second";
}

TEST(AlignerOfSeveralSenders, ASenderThatTakesOverOneOfSeveralChannelsLeavesTheOthers) {
  AlignerBench bench;
  bench.Stream(0, 500);
  bench.Wait(0.7);
  for (std::uint64_t s = 500; s < 1500; s += 10) {  // the second has p_A by now, the first comes back
    bench.now += 10 * kMs;
    SampleBatch other = bench.Rows(s, 10);
    other.session = 8;
    other.channels = {0};
    other.values.resize(10);
    bench.Add(other);
    bench.Add(bench.Rows(s + 700, 10));
    bench.aligner.Advance(bench.now);
    bench.Collect();
  }
  bench.Wait(0.5);
  EXPECT_GT(bench.got.rows(), 1300u);
  EXPECT_TRUE(std::isfinite(bench.got.signal[0].at(1300)));
  EXPECT_TRUE(std::isfinite(bench.got.signal[1].at(1300)));
  bench.ExpectTimesIncrease();
}

}  // namespace
}  // namespace hydroscope
