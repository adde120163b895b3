#include "acquisition/aligner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "acquisition/aligner_fixture.h"

namespace hydroscope {
namespace {

TEST(Aligner, RowsOfTheSenderAreRowsOfTheGridInSiUnits) {
  AlignerBench bench;
  bench.Stream(0, 1000);
  EXPECT_EQ(bench.Sequences(), Count(0, 1000));
  EXPECT_DOUBLE_EQ(bench.got.signal[0][500], 500e5);
  EXPECT_DOUBLE_EQ(bench.got.signal[1][500], 0.5);
  EXPECT_EQ(bench.got.quality[1][500], quality::kGood);
  EXPECT_EQ(bench.counters().missing_rows, 0);
}

TEST(Aligner, TimesAreWallTimesOfTheHostAndOneGridPeriodApart) {
  AlignerBench bench;
  bench.Stream(0, 1000);
  EXPECT_NEAR(bench.got.time[0], 1.7e9, 1e-3);
  for (std::size_t k = 1; k < 1000; ++k) ASSERT_NEAR(bench.got.time[k] - bench.got.time[k - 1], 1e-3, 1e-6);
}

TEST(Aligner, WhenARowWasSampledIsToldAtOnceAlsoAfterASlowStart) {
  AlignerBench bench;
  bench.now += 60 * kMs;  // the first messages wait so long
  for (std::uint64_t s = 0; s < 300; s += 10, bench.now += 10 * kMs) {
    bench.aligner.Advance(bench.now);
    bench.Add(bench.Rows(s, 10));
  }
  bench.now -= 60 * kMs;
  bench.Stream(300, 2000);
  const double sampled = static_cast<double>(bench.aligner.NewestSampled(0) - bench.now) * 1e-9;
  const double grid = bench.got.time.back() - static_cast<double>(kStartWall + bench.now - kStartMono) * 1e-9;
  EXPECT_NEAR(sampled, 0, 1e-3);
  EXPECT_GT(grid, 0.03) << "times of rows follow slowly";
}

TEST(Aligner, AReorderedBatchIsPutWhereItBelongs) {
  AlignerBench bench;
  bench.Stream(0, 500);
  bench.now += 20 * kMs;
  bench.Add(bench.Rows(510, 10));
  bench.Add(bench.Rows(500, 10));
  EXPECT_EQ(bench.Sequences(), Count(0, 520));
  EXPECT_EQ(bench.counters().reordered_batches, 1);
  EXPECT_EQ(bench.counters().late_rows, 0);
}

TEST(Aligner, ALostBatchIsMissingAfterTheLatenessAndWhatComesThenIsCountedLate) {
  AlignerBench bench;
  bench.Stream(0, 500);
  bench.Stream(510, 1000);
  auto expected = Count(0, 1000);
  std::fill(expected.begin() + 500, expected.begin() + 510, -1);
  bench.Wait(0.1);
  EXPECT_EQ(bench.Sequences(), expected);
  EXPECT_EQ(bench.got.quality[0][505], quality::kMissing | quality::kLate);
  EXPECT_TRUE(std::isnan(bench.got.signal[0][505]));
  bench.Add(bench.Rows(500, 10));
  EXPECT_EQ(bench.counters().late_rows, 10);
  EXPECT_EQ(bench.counters().missing_rows, 10);
  EXPECT_EQ(bench.got.rows(), 1000u);
}

TEST(Aligner, RowsThatComeTwiceAreTakenOnce) {
  AlignerBench bench;
  bench.Stream(0, 500);
  bench.now += 20 * kMs;
  bench.Add(bench.Rows(510, 10));
  bench.Add(bench.Rows(510, 10));
  bench.Add(bench.Rows(500, 10));
  EXPECT_EQ(bench.Sequences(), Count(0, 520));
  EXPECT_EQ(bench.counters().duplicate_rows, 10);
  EXPECT_EQ(bench.counters().contradicting_rows, 0);
}

TEST(Aligner, ARowThatComesAgainWithAnotherValueIsFlagged) {
  AlignerBench bench;
  bench.Stream(0, 500);
  bench.Add(bench.Rows(510, 10));
  SampleBatch other = bench.Rows(510, 10);
  other.values[0] += 1;
  bench.Add(other);
  bench.Add(bench.Rows(500, 10));
  EXPECT_EQ(bench.counters().contradicting_rows, 1);
  EXPECT_EQ(bench.got.quality[0][510], quality::kDuplicate);
  EXPECT_EQ(bench.got.quality[0][511], quality::kGood);
  EXPECT_DOUBLE_EQ(bench.got.signal[0][510], 510e5);
}

TEST(Aligner, SilenceGivesMissingRowsForASecondAndThenNone) {
  AlignerBench bench;
  bench.Stream(0, 500);
  bench.Wait(10);
  EXPECT_NEAR(static_cast<double>(bench.got.rows()), 1500, 20);
  const std::size_t before = bench.got.rows();
  bench.Stream(10'500, 11'000);
  EXPECT_EQ(bench.got.rows(), before + 500);
  EXPECT_EQ(bench.counters().gaps, 1);
  EXPECT_NE(bench.got.quality[0][before] & quality::kGap, 0);
  EXPECT_EQ(bench.got.quality[0][before + 1], quality::kGood);
  EXPECT_NEAR(bench.got.time[before] - bench.got.time[499], 10.001, 0.02);
  bench.ExpectTimesIncrease();
}

TEST(Aligner, RowsHeldUpInTheNetworkForFiveSecondsAreStillTaken) {
  AlignerBench bench;
  bench.Stream(0, 500);
  bench.Wait(5);
  for (std::uint64_t s = 500; s < 5500; s += 10) bench.Add(bench.Rows(s, 10));
  bench.Wait(0.1);
  EXPECT_NEAR(static_cast<double>(bench.counters().late_rows), 1000, 20);  // closed before the silence began
  EXPECT_EQ(bench.Sequences().back(), 5499);
  EXPECT_EQ(bench.counters().missing_rows, bench.counters().late_rows);
  EXPECT_EQ(static_cast<std::int64_t>(bench.got.rows()), 5500);
  bench.ExpectTimesIncrease();
}

TEST(Aligner, AStepOfTheSendersClockIsToldAndChangesNoOrder) {
  for (const std::int64_t hour : {3'600'000 * kMs, -3'600'000 * kMs}) {
    AlignerBench bench;
    bench.Stream(0, 1000);
    bench.sender_epoch += hour;
    bench.Stream(1000, 2000);
    EXPECT_EQ(bench.Sequences(), Count(0, 2000));
    EXPECT_EQ(bench.counters().clock_jumps, 1);
    EXPECT_EQ(bench.got.quality[0][1000], quality::kClockJump);
    EXPECT_EQ(bench.got.quality[0][1001], quality::kGood);
    bench.ExpectTimesIncrease();
    EXPECT_NEAR(bench.got.time[1999] - bench.got.time[0], 1.999, 0.002);
    EXPECT_NEAR(bench.aligner.streams()[0].clock_offset,
                static_cast<double>(kStartWall - bench.sender_epoch) * 1e-9, 0.02);
  }
}

TEST(Aligner, ASenderThatStartsAnewContinuesTheGridBehindAFlaggedGap) {
  AlignerBench bench;
  bench.Stream(0, 500);
  bench.Wait(2);
  const std::size_t before = bench.got.rows();
  bench.session = 8;
  for (std::uint64_t s = 0; s < 500; s += 10) {
    bench.now += 10 * kMs;
    bench.Add(bench.Rows(s, 10));
  }
  EXPECT_EQ(bench.got.rows(), before + 500);
  EXPECT_NE(bench.got.quality[0][before] & quality::kGap, 0);
  EXPECT_EQ(bench.counters().sessions, 2);
  EXPECT_EQ(bench.counters().late_rows, 0);
  bench.ExpectTimesIncrease();
}

TEST(Aligner, RowsFromTheFutureAreNotBelievedUntilTheSenderGoesOnThere) {
  AlignerBench bench;
  bench.Stream(0, 1000);
  bench.Add(bench.Rows(900'000, 10));
  EXPECT_EQ(bench.counters().future_rows, 10);
  bench.Stream(1000, 1500);
  EXPECT_EQ(bench.Sequences(), Count(0, 1500));
  for (std::uint64_t s = 900'000; s < 902'000; s += 10) {
    bench.now += 10 * kMs;
    bench.Add(bench.Rows(s, 10));
  }
  EXPECT_EQ(bench.counters().sequence_jumps, 1);
  EXPECT_EQ(bench.Sequences().back(), 901'999);
  bench.ExpectTimesIncrease();
}

TEST(Aligner, ACountThatFallsBackIsFollowedWhenItGoesOnThere) {
  AlignerBench bench;
  bench.Stream(0, 5000);
  for (std::uint64_t s = 0; s < 3000; s += 10) {
    bench.now += 10 * kMs;
    bench.aligner.Advance(bench.now);
    bench.Add(bench.Rows(s, 10));
  }
  EXPECT_EQ(bench.counters().sequence_jumps, 1);
  EXPECT_EQ(bench.Sequences().back(), 2999);
  EXPECT_GT(bench.counters().late_rows, 900);
  bench.ExpectTimesIncrease();
}

TEST(Aligner, ASlowChannelHoldsItsReadingAndGoesStaleAfterTwoPeriods) {
  AlignerBench bench;
  bench.Stream(0, 100);
  bench.Temperature(40);
  bench.Stream(100, 1000);
  const auto& flags = bench.got.quality[2];
  EXPECT_EQ(flags[50], quality::kMissing);
  EXPECT_EQ(flags[110], quality::kGood);
  EXPECT_DOUBLE_EQ(bench.got.signal[2][110], 313.15);
  EXPECT_EQ(flags[290], quality::kGood);
  EXPECT_EQ(flags[310], quality::kStale);
  EXPECT_GT(bench.counters().stale_values, 600);
  bench.Temperature(41);
  bench.Stream(1000, 1100);
  EXPECT_EQ(flags[1050], quality::kGood);
  EXPECT_DOUBLE_EQ(bench.got.signal[2][1050], 314.15);
}

TEST(Aligner, TheGridFollowsACrystalThatRunsFast) {
  AlignerBench bench;
  std::mt19937_64 random(1);
  std::uniform_int_distribution<std::int64_t> wait(0, 5 * kMs);
  for (std::uint64_t s = 0; s < 200'000; s += 10) {  // 100 ppm fast
    const auto taken = static_cast<std::int64_t>(static_cast<double>(s + 9) * 1e6 * (1 - 100e-6));
    bench.now = std::max(bench.now, kStartMono + taken + wait(random));
    bench.Add(bench.Rows(s, 10));
  }
  EXPECT_EQ(bench.Sequences(), Count(0, 200'000));
  EXPECT_NEAR(bench.got.time.back() - bench.got.time.front(), 200 * (1 - 100e-6), 0.003);
  EXPECT_NEAR(bench.aligner.streams()[0].drift, -100e-6, 20e-6);
}

TEST(Aligner, ASecondFastSenderIsAnchoredByTheClocks) {
  AlignerBench bench;
  const auto torque = [&](std::uint64_t first, std::uint64_t offset) {  // T_oil as a fast channel of axis 0
    SampleBatch batch{.session = 3,
                      .first_sequence = first + offset,
                      .source_time_ns = 0,
                      .period_ns = kMs,
                      .requested = {},
                      .received = {bench.now, 0},
                      .channels = {2},
                      .rows = 10,
                      .values = {}};
    for (std::size_t r = 0; r < 10; ++r) batch.values.push_back(static_cast<double>(first + r));
    bench.Add(batch);
  };
  for (std::uint64_t s = 0; s < 1000; s += 10) {
    bench.Stream(s, s + 10);
    torque(s, 123'456);
  }
  for (std::size_t k = 300; k < bench.got.rows(); ++k)
    ASSERT_NEAR(bench.got.signal[2][k] - 273.15, bench.got.signal[0][k] / 1e5, 1e-9) << k;
  EXPECT_GE(bench.got.rows(), 900u);
}

TEST(Aligner, RowsThatAnEarlierLifeStoredAreNotTakenAgain) {
  AlignerBench first;
  first.Stream(0, 500);
  const auto marks = first.aligner.marks(0);
  AlignerBench second;
  second.aligner.RestoreMarks(0, marks);
  second.now = kStartMono + 600 * kMs;
  for (std::uint64_t s = 300; s < 600; s += 10) second.Add(second.Rows(s, 10));
  second.Wait(1);
  EXPECT_EQ(second.counters().already_stored, 200);
  auto taken = second.Sequences();
  taken.resize(100);
  EXPECT_EQ(taken, Count(500, 600));
}

TEST(Aligner, AnotherLifeGoesOnBehindTheTimesOfTheOneBefore) {
  AlignerBench first;
  first.Stream(0, 500);
  const double last = first.got.time.back();
  for (const double ahead : {0.004, 5.0}) {  // s, what the first life's clock was off
    AlignerBench second;
    auto marks = first.aligner.marks(0);
    const double stored = last + ahead;
    std::memcpy(marks.data() + marks.size() - sizeof(stored), &stored, sizeof(stored));
    second.aligner.RestoreMarks(0, marks);
    second.Stream(500, 1000);
    ASSERT_GT(second.got.rows(), 0u);
    EXPECT_GT(second.got.time.front(), stored);
  }
}

TEST(Aligner, AClockThatWasSteppedBackBetweenTwoLivesIsBelieved) {
  AlignerBench first;
  first.Stream(0, 500);
  auto marks = first.aligner.marks(0);
  const double stored = first.got.time.back() + 3600;
  std::memcpy(marks.data() + marks.size() - sizeof(stored), &stored, sizeof(stored));
  AlignerBench second;
  second.aligner.RestoreMarks(0, marks);
  second.Stream(500, 1000);
  ASSERT_GT(second.got.rows(), 0u);
  EXPECT_LT(second.got.time.back(), stored - 3000);
}

TEST(Aligner, MarksWithoutATimeAreStillRead) {
  AlignerBench first;
  first.Stream(0, 500);
  auto marks = first.aligner.marks(0);
  marks.resize(marks.size() - sizeof(double));
  marks[0] = 1;  // version
  AlignerBench second;
  second.aligner.RestoreMarks(0, marks);
  second.now = kStartMono + 600 * kMs;
  for (std::uint64_t s = 300; s < 600; s += 10) second.Add(second.Rows(s, 10));
  second.Wait(1);
  EXPECT_EQ(second.counters().already_stored, 200);
}

TEST(Aligner, TheOtherAxisGivesNothingWhileNothingComesForIt) {
  AlignerBench bench;
  bench.Stream(0, 500);
  SampleBlock block;
  EXPECT_FALSE(bench.aligner.Take(1, block));
}

TEST(Aligner, BatchesThatCannotBeRightAreCounted) {
  AlignerBench bench;
  SampleBatch batch = bench.Rows(0, 10);
  batch.values.pop_back();
  bench.Add(batch);
  batch = bench.Rows(0, 10);
  batch.channels = {0, 600};
  bench.Add(batch);
  EXPECT_EQ(bench.aligner.malformed(), 2);
  EXPECT_EQ(bench.got.rows(), 0u);
}

TEST(Aligner, TheSameMessagesGiveTheSameRows) {
  AlignerBench one, other;
  for (AlignerBench* bench : {&one, &other}) {
    std::mt19937_64 random(5);
    for (std::uint64_t s = 0; s < 5000; s += 10) {
      bench->now += 10 * kMs;
      if (random() % 20 == 0) continue;
      bench->Add(bench->Rows(s, 10));
      if (random() % 20 == 0) bench->Add(bench->Rows(s > 50 ? s - 50 : 0, 10));
    }
    bench->Wait(1);
  }
  EXPECT_EQ(one.got.time, other.got.time);
  EXPECT_EQ(one.got.quality, other.got.quality);
  EXPECT_EQ(one.Sequences(), other.Sequences());
  EXPECT_GT(one.counters().missing_rows, 0);
}

}  // namespace
}  // namespace hydroscope
