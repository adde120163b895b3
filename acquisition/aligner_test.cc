#include "acquisition/aligner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

namespace hydroscope {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kStartMono = 1'000'000 * kMs, kStartWall = 1'700'000'000'000 * kMs;

Machine TwoAxes() {
  Machine machine;
  machine.name = "press";
  for (const auto& [name, unit] :
       std::vector<std::pair<std::string, std::string>>{{"p_A", "bar"}, {"z", "m"}, {"T_oil", "degC"}}) {
    machine.signals.emplace_back();
    machine.signals.back().name = name;
    machine.signals.back().unit = unit;
  }
  machine.live = LiveSpec{.grid_period = 1e-3, .axes = {"a", "b"}, .dds = DdsSpec{}, .modbus = {}};
  return machine;
}

/// Sends rows of p_A and z of axis 0: p_A = sequence bar, z = sequence mm / 1000.
struct Bench {
  Machine machine = TwoAxes();
  Aligner aligner{machine, AlignerOptions{}, {kStartMono, kStartWall}};
  std::int64_t now = kStartMono;  ///< ns; row s of the sender is taken at kStartMono + s ms
  std::uint64_t session = 7;
  std::int64_t sender_epoch = 5'000'000 * kMs;  ///< the sender's clock at its row 0
  SampleBlock got;                              ///< everything of axis 0 so far

  Bench() { got.Resize(3, 0); }

  SampleBatch Rows(std::uint64_t first, std::size_t rows) const {
    SampleBatch batch{.session = session,
                      .first_sequence = first,
                      .source_time_ns = sender_epoch + static_cast<std::int64_t>(first) * kMs,
                      .period_ns = kMs,
                      .requested = {},
                      .received = {now, 0},
                      .channels = {0, 1},
                      .rows = rows,
                      .values = {}};
    for (std::size_t r = 0; r < rows; ++r) {
      batch.values.push_back(static_cast<double>(first + r));
      batch.values.push_back(static_cast<double>(first + r) * 1e-3);
    }
    return batch;
  }
  void Collect() {
    SampleBlock block;
    while (aligner.Take(0, block)) {
      got.time.insert(got.time.end(), block.time.begin(), block.time.end());
      for (std::size_t s = 0; s < 3; ++s) {
        got.signal[s].insert(got.signal[s].end(), block.signal[s].begin(), block.signal[s].end());
        got.quality[s].insert(got.quality[s].end(), block.quality[s].begin(), block.quality[s].end());
      }
    }
  }
  void Add(const SampleBatch& batch) {
    aligner.Add(0, batch);
    Collect();
  }
  void Wait(double seconds) {
    for (const std::int64_t end = now + std::llround(seconds * 1e9); now < end; now += 10 * kMs) {
      aligner.Advance(now);
      Collect();
    }
  }
  /// Batches of ten rows from `first` on, each sent when its last row was taken.
  void Stream(std::uint64_t first, std::uint64_t last) {
    for (std::uint64_t s = first; s < last; s += 10) {
      now = std::max(now, kStartMono + static_cast<std::int64_t>(s + 9) * kMs);
      aligner.Advance(now);
      Add(Rows(s, 10));
    }
  }
  void Temperature(double celsius) {
    aligner.Add(1, {.session = 1,
                    .first_sequence = 0,
                    .requested = {now - kMs, 0},
                    .received = {now, 0},
                    .channels = {2},
                    .rows = 1,
                    .values = {celsius}});
  }
  const AlignerCounters& counters() const { return aligner.counters(0); }
  /// Sequence numbers given out, -1 for a missing row.
  std::vector<int> Sequences() const {
    std::vector<int> numbers;
    for (std::size_t k = 0; k < got.rows(); ++k)
      numbers.push_back(
          got.quality[0][k] & quality::kMissing ? -1 : static_cast<int>(std::lround(got.signal[0][k] / 1e5)));
    return numbers;
  }
  void ExpectTimesIncrease() const {
    for (std::size_t k = 1; k < got.rows(); ++k) ASSERT_GT(got.time[k], got.time[k - 1]) << k;
  }
};

std::vector<int> Count(int first, int last) {
  std::vector<int> numbers;
  for (int i = first; i < last; ++i) numbers.push_back(i);
  return numbers;
}

TEST(Aligner, RowsOfTheSenderAreRowsOfTheGridInSiUnits) {
  Bench bench;
  bench.Stream(0, 1000);
  EXPECT_EQ(bench.Sequences(), Count(0, 1000));
  EXPECT_DOUBLE_EQ(bench.got.signal[0][500], 500e5);
  EXPECT_DOUBLE_EQ(bench.got.signal[1][500], 0.5);
  EXPECT_EQ(bench.got.quality[1][500], quality::kGood);
  EXPECT_EQ(bench.counters().missing_rows, 0);
}

TEST(Aligner, TimesAreWallTimesOfTheHostAndOneGridPeriodApart) {
  Bench bench;
  bench.Stream(0, 1000);
  EXPECT_NEAR(bench.got.time[0], 1.7e9, 1e-3);
  for (std::size_t k = 1; k < 1000; ++k) ASSERT_NEAR(bench.got.time[k] - bench.got.time[k - 1], 1e-3, 1e-6);
}

TEST(Aligner, AReorderedBatchIsPutWhereItBelongs) {
  Bench bench;
  bench.Stream(0, 500);
  bench.now += 20 * kMs;
  bench.Add(bench.Rows(510, 10));
  bench.Add(bench.Rows(500, 10));
  EXPECT_EQ(bench.Sequences(), Count(0, 520));
  EXPECT_EQ(bench.counters().reordered_batches, 1);
  EXPECT_EQ(bench.counters().late_rows, 0);
}

TEST(Aligner, ALostBatchIsMissingAfterTheLatenessAndWhatComesThenIsCountedLate) {
  Bench bench;
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
  Bench bench;
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
  Bench bench;
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
  Bench bench;
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
  Bench bench;
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
    Bench bench;
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
  Bench bench;
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
  Bench bench;
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
  Bench bench;
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
  Bench bench;
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
  Bench bench;
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
  Bench bench;
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
  Bench first;
  first.Stream(0, 500);
  const auto marks = first.aligner.marks(0);
  Bench second;
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
  Bench first;
  first.Stream(0, 500);
  const double last = first.got.time.back();
  for (const double ahead : {0.004, 5.0}) {  // s, what the first life's clock was off
    Bench second;
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
  Bench first;
  first.Stream(0, 500);
  auto marks = first.aligner.marks(0);
  const double stored = first.got.time.back() + 3600;
  std::memcpy(marks.data() + marks.size() - sizeof(stored), &stored, sizeof(stored));
  Bench second;
  second.aligner.RestoreMarks(0, marks);
  second.Stream(500, 1000);
  ASSERT_GT(second.got.rows(), 0u);
  EXPECT_LT(second.got.time.back(), stored - 3000);
}

TEST(Aligner, MarksWithoutATimeAreStillRead) {
  Bench first;
  first.Stream(0, 500);
  auto marks = first.aligner.marks(0);
  marks.resize(marks.size() - sizeof(double));
  marks[0] = 1;  // version
  Bench second;
  second.aligner.RestoreMarks(0, marks);
  second.now = kStartMono + 600 * kMs;
  for (std::uint64_t s = 300; s < 600; s += 10) second.Add(second.Rows(s, 10));
  second.Wait(1);
  EXPECT_EQ(second.counters().already_stored, 200);
}

TEST(Aligner, TheOtherAxisGivesNothingWhileNothingComesForIt) {
  Bench bench;
  bench.Stream(0, 500);
  SampleBlock block;
  EXPECT_FALSE(bench.aligner.Take(1, block));
}

TEST(Aligner, OfTwoSendersTheFirstGivesAllItsRows) {
  Bench bench;
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

TEST(Aligner, TheSecondSenderGoesOnWhereTheFirstFellSilent) {
  Bench bench;
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

TEST(Aligner, RowsWithTheSameSessionFromAnotherWriterNeverEnter) {
  Bench bench;
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

TEST(Aligner, ASecondSenderOfSomeChannelsGivesThoseThatNobodyElseSends) {
  Bench bench;
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

TEST(Aligner, ASenderThatTakesOverOneOfSeveralChannelsLeavesTheOthers) {
  Bench bench;
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

TEST(Aligner, BatchesThatCannotBeRightAreCounted) {
  Bench bench;
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
  Bench one, other;
  for (Bench* bench : {&one, &other}) {
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
