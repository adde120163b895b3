#include "acquisition/quality_monitor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

namespace hydroscope {
namespace {

constexpr double kPeriod = 0.002;  // s

/// One channel "p", its readings, and the flags the monitor gave them.
class QualityMonitorTest : public ::testing::Test {
 protected:
  QualityMonitorTest() {
    SignalSpec spec;
    spec.name = "p";
    machine_.signals = {spec};
  }

  /// `count` readings of white noise on `level`.
  void AddNoise(int count, double level = 0, double std = 1) {
    std::normal_distribution<double> noise(level, std);
    for (int i = 0; i < count; ++i) readings_.push_back(noise(random_));
  }
  void AddSame(int count) {
    readings_.insert(readings_.end(), static_cast<std::size_t>(count), readings_.back());
  }

  /// Flags per reading.
  std::vector<Quality> Run(std::size_t block_rows = 100) {
    QualityMonitor monitor(machine_, kPeriod);
    std::vector<Quality> flags;
    given_.clear();
    SampleBlock block;
    const auto keep = [&] {
      flags.insert(flags.end(), block.quality[0].begin(), block.quality[0].end());
      given_.insert(given_.end(), block.signal[0].begin(), block.signal[0].end());
    };
    for (std::size_t at = 0; at < readings_.size(); at += block_rows) {
      const std::size_t rows = std::min(block_rows, readings_.size() - at);
      block.Resize(1, rows);
      for (std::size_t i = 0; i < rows; ++i) {
        block.time[i] = static_cast<double>(at + i) * kPeriod;
        block.signal[0][i] = readings_[at + i];
        block.quality[0][i] = std::isnan(readings_[at + i]) ? quality::kMissing : quality::kGood;
      }
      monitor.Inspect(block);
      keep();
    }
    monitor.Flush(block);
    keep();
    channel_ = monitor.channels()[0];
    return flags;
  }
  static int Count(const std::vector<Quality>& flags, Quality flag) {
    return static_cast<int>(
        std::count_if(flags.begin(), flags.end(), [&](Quality q) { return (q & flag) != 0; }));
  }

  Machine machine_;
  std::mt19937 random_{7};
  std::vector<double> readings_;
  std::vector<double> given_;
  ChannelQuality channel_;
};

TEST_F(QualityMonitorTest, GivesOutEveryRowOnce) {
  AddNoise(1001);
  Run();
  EXPECT_EQ(given_, readings_);
  EXPECT_EQ(channel_.rows, 1001);
}

TEST_F(QualityMonitorTest, LeavesPlainNoiseAlone) {
  AddNoise(200000, 50, 2);
  const auto flags = Run();
  EXPECT_EQ(Count(flags, 0xffff), 0);
  EXPECT_TRUE(std::isnan(channel_.first_bad));
}

TEST_F(QualityMonitorTest, EstimatesTheNoiseUnderMotion) {
  for (int i = 0; i < 50000; ++i) {
    AddNoise(1, 1000 * std::sin(i * kPeriod * 3), 0.5);
  }
  Run();
  EXPECT_NEAR(channel_.noise_std, 0.5, 0.06);
}

TEST_F(QualityMonitorTest, FlagsReadingsOutsideTheLimits) {
  machine_.signals[0].min = -10;
  machine_.signals[0].max = 10;
  readings_ = {0, 11, 10, -10, -10.5, 0, 3};
  EXPECT_THAT(Run(), ::testing::ElementsAre(0, quality::kOutOfRange, 0, 0, quality::kOutOfRange, 0, 0));
  EXPECT_EQ(channel_.flagged[3], 2);
  EXPECT_DOUBLE_EQ(channel_.first_bad, kPeriod);
  EXPECT_DOUBLE_EQ(channel_.last_bad, 4 * kPeriod);
}

TEST_F(QualityMonitorTest, FlagsASpike) {
  AddNoise(1000);
  readings_[500] += 40;
  const auto flags = Run();
  EXPECT_EQ(Count(flags, quality::kSpike), 1);
  EXPECT_EQ(flags[500], quality::kSpike);
}

TEST_F(QualityMonitorTest, AMarkerOfEpisodesMayJumpAndRest) {
  AddNoise(1000);
  readings_[500] += 40;
  AddSame(2000);
  AddNoise(100);
  const auto judged = Run();
  ASSERT_GT(Count(judged, quality::kSpike) + Count(judged, quality::kStuck), 0);
  machine_.episode_marker = "p";
  const auto flags = Run();
  EXPECT_EQ(Count(flags, quality::kSpike) + Count(flags, quality::kStuck), 0);
}

TEST_F(QualityMonitorTest, FlagsASpikeAtEveryPlaceInABlock) {
  for (int at = 500; at < 520; ++at) {
    readings_.clear();
    AddNoise(1000);
    readings_[static_cast<std::size_t>(at)] += 60;
    EXPECT_EQ(Run(10)[static_cast<std::size_t>(at)], quality::kSpike) << at;
  }
}

TEST_F(QualityMonitorTest, FlagsAPulseOfAFewRowsHoweverRowsAreCut) {
  AddNoise(2000);
  for (const int length : {2, 3, 4})
    for (int k = 0; k < length; ++k) readings_[static_cast<std::size_t>(300 * length + k)] += 80;
  for (const std::size_t block_rows : {1, 3, 7, 100, 2000}) {
    const auto flags = Run(block_rows);
    EXPECT_EQ(given_, readings_);
    EXPECT_EQ(Count(flags, quality::kSpike), 9) << block_rows;
    for (const std::size_t at : {600, 601, 900, 902, 1200, 1203}) EXPECT_EQ(flags[at], quality::kSpike) << at;
  }
}

TEST_F(QualityMonitorTest, StepsNearTheLeastThatAPulseMayHaveAreFlaggedTheSameHoweverRowsAreCut) {
  std::mt19937 random(3);
  AddNoise(20'000);
  for (std::size_t at = 100; at + 20 < readings_.size(); at += 7 + random() % 20) {
    const double size = 8 + static_cast<double>(random() % 50);
    for (std::size_t k = 0; k < 1 + random() % 5; ++k) readings_[at + k] += size;
  }
  const auto whole = Run(readings_.size());
  EXPECT_GT(Count(whole, quality::kSpike), 300);
  for (const std::size_t block_rows : {1, 5, 64, 1000}) EXPECT_EQ(Run(block_rows), whole) << block_rows;
}

TEST_F(QualityMonitorTest, TakesAPulseOfFiveRowsForMotion) {
  AddNoise(2000);
  for (std::size_t k = 900; k < 905; ++k) readings_[k] += 80;
  EXPECT_EQ(Count(Run(), quality::kSpike), 0);
}

TEST_F(QualityMonitorTest, TakesAStepForNoSpike) {
  AddNoise(500);
  AddNoise(500, 1000);
  EXPECT_EQ(Count(Run(), quality::kSpike), 0);
}

TEST_F(QualityMonitorTest, TakesOscillationForNoSpike) {
  for (int i = 0; i < 5000; ++i) AddNoise(1, i < 1000 ? 0 : 500 * std::sin(i * 0.8), 0.1);
  EXPECT_EQ(Count(Run(), quality::kSpike), 0);
}

TEST_F(QualityMonitorTest, JudgesNoSpikeBesideMissingReadings) {
  AddNoise(1000);
  readings_[499] = std::nan("");
  readings_[500] += 40;
  EXPECT_EQ(Count(Run(), quality::kSpike), 0);
}

TEST_F(QualityMonitorTest, FlagsAStuckSensorFromItsFirstReadingOn) {
  AddNoise(1000);
  AddSame(200);
  AddNoise(100);
  const auto flags = Run();
  EXPECT_EQ(flags[998], quality::kGood);
  EXPECT_EQ(flags[999], quality::kStuck);
  EXPECT_EQ(flags[999 + 51], quality::kStuck);
  EXPECT_EQ(flags[999 + 200], quality::kStuck);
  EXPECT_EQ(flags[999 + 201], quality::kGood);
}

TEST_F(QualityMonitorTest, FlagsAStuckSensorWhoseNoiseHidesInItsMotion) {
  std::normal_distribution<double> noise(0, 0.02);
  for (int i = 0; i < 3000; ++i) readings_.push_back(100 * std::sin(0.05 * i) + noise(random_));
  std::fill_n(readings_.begin() + 1500, 300, readings_[1499]);
  const auto flags = Run();
  EXPECT_EQ(Count(flags, quality::kStuck), 301);
  EXPECT_EQ(flags[1498], quality::kGood);
  EXPECT_EQ(flags[1499], quality::kStuck);
  EXPECT_EQ(Run(7), flags);
}

TEST_F(QualityMonitorTest, TakesARestWithoutNoiseForNoStuckSensor) {
  for (const double per_row : {0.005, 0.05})  // of the slower one rounding hides third differences
    for (const double resolution : {0.0, 1e-6, 1e-4}) {
      readings_.clear();
      for (int i = 0; i < 3000; ++i) {
        const double x = std::sin(per_row * std::min(i, 1500));
        readings_.push_back(resolution > 0 ? resolution * std::round(x / resolution) : x);
      }
      EXPECT_EQ(Count(Run(), quality::kStuck), 0) << per_row << " " << resolution;
    }
}

TEST_F(QualityMonitorTest, FlagsAGapThatALoggerFilledWithAConstant) {
  for (const double resolution : {0.0, 2.0})  // coarser than the noise: readings repeat
    for (const int rows : {2, 5, 20}) {
      readings_.clear();
      AddNoise(3000, 100);
      if (resolution > 0)
        for (double& x : readings_) x = resolution * std::round(x / resolution);
      for (std::size_t at = 1000; at < 3000; at += 500)
        std::fill_n(readings_.begin() + static_cast<std::ptrdiff_t>(at), rows, 0.0);
      const auto flags = Run();
      EXPECT_EQ(Count(flags, quality::kStuck), 4 * rows) << resolution << " " << rows;
      EXPECT_EQ(flags[999], quality::kGood);
      EXPECT_EQ(flags[1000], quality::kStuck);
      EXPECT_EQ(Run(7), flags);
    }
}

TEST_F(QualityMonitorTest, FlagsReadingsThatALoggerHeld) {
  AddNoise(3000);
  AddSame(4);
  AddNoise(3000);
  const auto flags = Run();
  EXPECT_EQ(flags[2998], quality::kGood);
  EXPECT_EQ(Count(flags, quality::kStuck), 5);
}

TEST_F(QualityMonitorTest, TakesStepsOfACommandForNoGap) {
  for (int k = 0; k < 400; ++k) {
    AddNoise(1, k % 2 == 0 ? 0 : 100, 0);
    AddSame(20 + k % 7);
  }
  EXPECT_EQ(Count(Run(), quality::kStuck), 0);
}

TEST_F(QualityMonitorTest, NeverFlagsStuckWithStuckTimeZero) {
  machine_.signals[0].stuck_time = 0;
  AddNoise(1000);
  AddSame(2000);
  EXPECT_EQ(Count(Run(), quality::kStuck), 0);
}

TEST_F(QualityMonitorTest, LeavesCoarselyQuantisedTemperatureAlone) {
  std::normal_distribution<double> noise(0, 0.02);
  for (int i = 0; i < 100000; ++i)
    readings_.push_back(std::round((40 + 2 * std::sin(i * 1e-4) + noise(random_)) * 10) / 10);
  EXPECT_EQ(Count(Run(), 0xffff), 0);
}

TEST_F(QualityMonitorTest, LeavesARestingCommandWithoutNoiseAlone) {
  for (int i = 0; i < 20000; ++i)
    readings_.push_back(i % 2000 < 1000 ? 0 : std::sin((i % 1000) * 0.00314159) * 10);
  EXPECT_EQ(Count(Run(), quality::kStuck), 0);
}

TEST_F(QualityMonitorTest, ResultsDoNotDependOnBlockSize) {
  machine_.signals[0].max = 2.5;
  AddNoise(3000);
  AddSame(150);
  AddNoise(2000, 0, 5);
  for (std::size_t at = 100; at < 5000; at += 333) readings_[at] += 200;
  readings_[1500] = std::nan("");
  const auto flags = Run(1024);
  const ChannelQuality channel = channel_;
  EXPECT_GT(Count(flags, quality::kSpike), 5);
  EXPECT_GT(Count(flags, quality::kStuck), 40);
  for (const std::size_t rows : {1u, 2u, 3u, 7u, 100000u}) {
    EXPECT_EQ(Run(rows), flags) << rows;
    EXPECT_EQ(channel_.flagged, channel.flagged) << rows;
    EXPECT_EQ(channel_.noise_std, channel.noise_std) << rows;
  }
}

TEST_F(QualityMonitorTest, CopiesGoOnAlike) {
  AddNoise(1000);
  QualityMonitor monitor(machine_, kPeriod);
  SampleBlock block;
  block.Resize(1, 1000);
  block.signal[0] = readings_;
  monitor.Inspect(block);
  QualityMonitor copy = monitor;
  SampleBlock a, b;
  monitor.Flush(a);
  copy.Flush(b);
  EXPECT_EQ(a.signal, b.signal);
  EXPECT_EQ(a.rows(), 6u);  // nothing stands still: what spikes need
}

TEST_F(QualityMonitorTest, FlagsReadingsCutOffAtARoundLimit) {
  for (const double limit : {200.0, -200.0}) {
    readings_.clear();
    AddNoise(2000, 0.5 * limit, 2);
    AddNoise(2000, limit, 2);
    for (double& x : readings_) x = limit > 0 ? std::min(x, limit) : std::max(x, limit);
    const auto at = std::count(readings_.begin(), readings_.end(), limit);
    const int flagged = Count(Run(), quality::kOutOfRange);
    EXPECT_GT(flagged, 0.9 * static_cast<double>(at)) << limit;
    EXPECT_LE(flagged, at) << limit;
  }
}

TEST_F(QualityMonitorTest, TakesTheHighestReadingsOfACoarseSensorForNoLimit) {
  for (const double quantum : {0.1, 0.5, 1.0}) {
    readings_.clear();
    AddNoise(100000, 50, 1);
    for (double& x : readings_) x = quantum * std::round(x / quantum);
    EXPECT_EQ(Count(Run(), quality::kOutOfRange), 0) << quantum;
  }
}

}  // namespace
}  // namespace hydroscope
