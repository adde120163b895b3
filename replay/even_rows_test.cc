#include "replay/even_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <functional>
#include <random>

#include "core/constants.h"
#include "replay/time_check.h"

namespace hydroscope {
namespace {

using ::testing::HasSubstr;

/// A ram that goes up and down, and a signal of noise alone, with the stamps of some logger.
struct Log {
  std::vector<double> sampled, stamp;  // s
  double noise = 1e-4;                 // m
};

class Reader : public LogReader {
 public:
  explicit Reader(Log log) : log_(std::move(log)), check_(SamplePeriodOf(log_.stamp)) {}
  Result<std::size_t> Read(SampleBlock& block, std::size_t max_rows) override {
    const std::size_t rows = std::min(max_rows, log_.stamp.size() - next_);
    block.Resize(2, rows);
    for (std::size_t row = 0; row < rows; ++row, ++next_) {
      block.time[row] = log_.stamp[next_];
      block.signal[0][row] = 0.1 * std::sin(kTwoPi * log_.sampled[next_] / 3) + log_.noise * normal_(random_);
      block.signal[1][row] = normal_(random_);
      for (auto& flags : block.quality) flags[row] = quality::kGood;
    }
    check_.Check(block, counters_);
    counters_.rows = static_cast<std::int64_t>(next_);
    return rows;
  }
  double Progress() const override { return 0; }
  double SamplePeriod() const override { return 0; }
  const LogCounters& counters() const override { return counters_; }

 private:
  Log log_;
  TimeChecker check_;
  std::size_t next_ = 0;
  LogCounters counters_;
  std::mt19937 random_{7};
  std::normal_distribution<double> normal_;
};

/// `rows` rows `period` s apart, each stamped by `stamp`, without those that `lost` is true of.
Log LogOf(
    double period, int rows, const std::function<double(double)>& stamp,
    const std::function<bool(int)>& lost = [](int) { return false; }) {
  Log log;
  for (int row = 0; row < rows; ++row) {
    const double t = 40 + row * period;
    const double stamped = stamp(t);
    if (lost(row)) continue;
    log.sampled.push_back(t);
    log.stamp.push_back(stamped);
  }
  return log;
}

std::function<double(double)> RoundedTo(double step) {
  return [step](double t) { return std::floor(t / step) * step; };
}

/// Late by up to 0.8 periods, every second time, but never before the row before.
std::function<double(double)> StoredLate(double period) {
  return [=, random = std::mt19937(3), last = 0.0](double t) mutable {
    std::uniform_real_distribution<double> late(-0.8 * period, 0.8 * period);
    return last = std::max(last, t + std::max(0.0, late(random)));
  };
}

std::optional<EvenRows> Find(const Log& log) {
  Reader reader(log);
  return FindEvenRows(reader).value();
}

/// How far the times that rows get are from those they were sampled at, but for a distance that is the same for all; s.
double FarthestOff(const Log& log, const EvenRows& rows) {
  const auto reader = WithEvenTimes(std::make_unique<Reader>(log), rows);
  double low = kInfinity, high = -kInfinity;
  SampleBlock block;
  for (std::size_t at = 0; reader->Read(block, 700).value() > 0; at += block.rows())
    for (std::size_t row = 0; row < block.rows(); ++row) {
      low = std::min(low, block.time[row] - log.sampled[at + row]);
      high = std::max(high, block.time[row] - log.sampled[at + row]);
    }
  return high - low;
}

TEST(EvenRows, HaveStampsCoarserThanTheRows) {
  for (const double step : {0.01, 0.0156, 0.1, 1.0}) {
    const Log log = LogOf(0.002, 60000, RoundedTo(step));
    const auto rows = Find(log);
    ASSERT_TRUE(rows) << step;
    EXPECT_NEAR(rows->period, 0.002, 2e-6 * std::max(1.0, step / 0.1)) << step;
    EXPECT_EQ(rows->pieces.size(), 1u) << step;
    EXPECT_LT(FarthestOff(log, *rows), 0.1 * step) << step;
    EXPECT_THAT(rows->why.english, HasSubstr("repeat the time stamp"));
  }
}

TEST(EvenRows, AreStampedWhenTheyWereStored) {
  const Log log = LogOf(0.002, 30000, StoredLate(0.002));
  const auto rows = Find(log);
  ASSERT_TRUE(rows);
  EXPECT_NEAR(rows->period, 0.002, 1e-8);
  EXPECT_LT(FarthestOff(log, *rows), 5e-5);
  EXPECT_THAT(rows->why.english, HasSubstr("when a row was stored"));
}

TEST(EvenRows, RowsThatWereSampledAtUnevenTimesKeepTheirStamps) {
  Log log = LogOf(0.002, 30000, StoredLate(0.002));
  log.sampled = log.stamp;
  log.noise = 1e-5;
  EXPECT_FALSE(Find(log));
}

TEST(EvenRows, NoiseThatHidesTheMotionLeavesTheStamps) {
  Log log = LogOf(0.002, 30000, StoredLate(0.002));
  log.noise = 0.1;
  EXPECT_FALSE(Find(log));
}

TEST(EvenRows, MissingRowsBecomeGaps) {
  const auto lost = [](int row) {
    return row == 5000 || row == 9100 || (row > 14000 && row < 14020) || (row > 20000 && row < 20500);
  };
  for (const auto& stamp : {RoundedTo(0.01), StoredLate(0.002)}) {
    const Log log = LogOf(0.002, 30000, stamp, lost);
    const auto rows = Find(log);
    ASSERT_TRUE(rows);
    ASSERT_EQ(rows->pieces.size(), 5u);
    EXPECT_NEAR(static_cast<double>(rows->pieces[1].first), 5000, 5);
    EXPECT_LT(FarthestOff(log, *rows), 0.0021);  // a row or two on the wrong side of a gap
    const auto reader = WithEvenTimes(std::make_unique<Reader>(log), *rows);
    SampleBlock block;
    while (reader->Read(block, 1000).value() > 0) {
    }
    constexpr int kGapBit = std::countr_zero(static_cast<unsigned>(quality::kGap));
    EXPECT_EQ(reader->counters().flagged[kGapBit], 2 * 4);
    EXPECT_EQ(reader->counters().time_base, rows->why);
  }
}

TEST(EvenRows, AClockThatJumpsBeginsAnew) {
  const Log log = LogOf(0.002, 30000, [](double t) { return RoundedTo(0.01)(t) + (t > 70 ? -3600 : 0); });
  const auto rows = Find(log);
  ASSERT_TRUE(rows);
  ASSERT_EQ(rows->pieces.size(), 2u);
  EXPECT_NEAR(rows->pieces[1].time, 70 - 3600, 0.1);
  const auto reader = WithEvenTimes(std::make_unique<Reader>(log), *rows);
  SampleBlock block;
  while (reader->Read(block, 1000).value() > 0) {
  }
  constexpr int kJumpBit = std::countr_zero(static_cast<unsigned>(quality::kClockJump));
  EXPECT_EQ(reader->counters().flagged[kJumpBit], 2);
}

TEST(EvenRows, AShortLogKeepsItsStamps) { EXPECT_FALSE(Find(LogOf(0.002, 700, RoundedTo(0.01)))); }

TEST(EvenRows, RowsOfTwoRatesKeepTheirStamps) {
  Log log = LogOf(0.002, 10000, RoundedTo(0.01));
  const Log slow = LogOf(0.0031, 10000, RoundedTo(0.01));
  for (std::size_t row = 0; row < slow.stamp.size(); ++row) {
    log.sampled.push_back(slow.sampled[row] + 20);
    log.stamp.push_back(slow.stamp[row] + 20);
  }
  EXPECT_FALSE(Find(log));
}

TEST(EvenRows, GoodStampsAreLeftAsTheyAre) {
  const auto head = [](const std::function<double(double)>& stamp) {
    Reader reader(LogOf(0.002, 1000, stamp));
    SampleBlock block;
    reader.Read(block, 1000).value();
    return block;
  };
  EXPECT_FALSE(MayBeEvenRows(head([](double t) { return t; })));
  EXPECT_TRUE(MayBeEvenRows(head(RoundedTo(0.01))));
  EXPECT_TRUE(MayBeEvenRows(head(StoredLate(0.002))));
}

}  // namespace
}  // namespace hydroscope
