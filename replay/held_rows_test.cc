#include "replay/held_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "replay/time_check.h"

namespace hydroscope {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Machine MachineOf(const std::vector<bool>& required) {
  Machine machine;
  for (const bool needed : required) {
    SignalSpec signal;
    signal.required = needed;
    machine.signals.push_back(signal);
  }
  return machine;
}

/// Rows 1 ms apart; signal s is noise that changes every `every[s]` rows, 0: never.
class Logger : public LogReader {
 public:
  Logger(std::vector<int> every, std::int64_t rows)
      : every_(std::move(every)), rows_(rows), value_(every_.size(), 5) {}
  Result<std::size_t> Read(SampleBlock& block, std::size_t max_rows) override {
    const auto rows = std::min<std::size_t>(max_rows, static_cast<std::size_t>(rows_ - next_));
    block.Resize(every_.size(), rows);
    for (std::size_t row = 0; row < rows; ++row, ++next_) {
      block.time[row] = 1e-3 * static_cast<double>(next_);
      for (std::size_t s = 0; s < every_.size(); ++s) {
        if (every_[s] > 0 && next_ % every_[s] == 0) value_[s] = normal_(random_);
        block.signal[s][row] = value_[s];
        block.quality[s][row] = quality::kGood;
      }
    }
    check_.Check(block, counters_);
    counters_.rows = next_;
    return rows;
  }
  double Progress() const override { return 0; }
  double SamplePeriod() const override { return 1e-3; }
  const LogCounters& counters() const override { return counters_; }

 private:
  std::vector<int> every_;
  std::int64_t rows_, next_ = 0;
  std::vector<double> value_;
  TimeChecker check_{1e-3};
  LogCounters counters_;
  std::mt19937 random_{5};
  std::normal_distribution<double> normal_;
};

std::optional<HeldRows> Find(const std::vector<int>& every, const std::vector<bool>& required) {
  Logger logger(every, 1000);
  SampleBlock head;
  logger.Read(head, 1000).value();
  return FindHeldRows(head, MachineOf(required));
}

TEST(HeldRows, AreLeftOut) {
  const auto held = Find({4, 4, 1}, {true, true, false});
  ASSERT_TRUE(held);
  EXPECT_THAT(held->signals, ElementsAre(0, 1));
  EXPECT_DOUBLE_EQ(held->period, 4e-3);
  EXPECT_THAT(held->why.english, HasSubstr("change together every 4 rows"));
  const auto reader = WithoutHeldRows(std::make_unique<Logger>(std::vector{4, 4, 1}, 10000), *held);
  EXPECT_EQ(reader->counters().time_base, held->why);
  std::vector<double> times;
  SampleBlock block;
  while (reader->Read(block, 301).value() > 0)
    times.insert(times.end(), block.time.begin(), block.time.end());
  ASSERT_EQ(times.size(), 2500u);
  for (std::size_t k = 0; k < times.size(); ++k) ASSERT_NEAR(times[k], 4e-3 * static_cast<double>(k), 1e-9);
  EXPECT_EQ(reader->counters().rows, 2500);
  for (const std::int64_t flagged : reader->counters().flagged) EXPECT_EQ(flagged, 0);
}

TEST(HeldRows, AreNoneWhereANeededSignalChangesFromRowToRow) {
  EXPECT_FALSE(Find({4, 4, 1}, {true, true, true}));
}

TEST(HeldRows, ASignalThatStandsStillAloneIsLate) { EXPECT_FALSE(Find({4, 0, 1}, {true, true, false})); }

TEST(HeldRows, SignalsThatChangeByTurnsAreNotHeldTogether) {
  EXPECT_FALSE(Find({4, 6, 1}, {true, true, false}));
}

TEST(HeldRows, SlowSignalsThatNobodyNeedsAreNotHeard) {
  EXPECT_FALSE(Find({1, 10, 10}, {true, false, false}));
}

}  // namespace
}  // namespace hydroscope
