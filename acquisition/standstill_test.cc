#include "acquisition/standstill.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "acquisition/quality_monitor.h"
#include "simulator/die_cushion/press.h"

namespace hydroscope {
namespace {

enum Channel { kPressure, kPosition, kSpool, kCommand };

Machine Cushion() {
  Machine machine;
  machine.model = "die_cushion";
  for (const char* name : {"p_A", "z", "y_v", "U_v"}) {
    SignalSpec spec;
    spec.name = name;
    machine.signals.push_back(spec);
  }
  return machine;
}

SampleBlock Press(std::uint64_t seed, double seconds = 60) {
  PressOptions options;
  options.seconds = seconds;
  options.seed = seed;
  const SimulatedLog log = SimulatePress(options);
  SampleBlock rows;
  rows.Resize(4, log.rows());
  rows.time = log.t;
  rows.signal = {log.p_A, log.z, log.y_v, log.U_v};
  for (auto& flags : rows.quality) std::fill(flags.begin(), flags.end(), quality::kGood);
  return rows;
}

/// Flags of a channel, rows sent in blocks.
std::vector<Quality> Flags(const SampleBlock& rows, Channel channel, std::size_t block_rows = 1000) {
  QualityMonitor monitor(Cushion(), 0.002);
  std::vector<Quality> flags;
  SampleBlock block;
  for (std::size_t at = 0; at < rows.rows(); at += block_rows) {
    const std::size_t count = std::min(block_rows, rows.rows() - at);
    block.Resize(4, count);
    for (std::size_t c = 0; c < 4; ++c) {
      std::copy_n(rows.signal[c].begin() + static_cast<std::ptrdiff_t>(at), count, block.signal[c].begin());
      std::fill(block.quality[c].begin(), block.quality[c].end(), quality::kGood);
    }
    std::copy_n(rows.time.begin() + static_cast<std::ptrdiff_t>(at), count, block.time.begin());
    monitor.Inspect(block);
    flags.insert(flags.end(), block.quality[channel].begin(), block.quality[channel].end());
  }
  monitor.Flush(block);
  flags.insert(flags.end(), block.quality[channel].begin(), block.quality[channel].end());
  return flags;
}

std::int64_t Stuck(const std::vector<Quality>& flags, std::size_t from, std::size_t to) {
  return std::count_if(flags.begin() + static_cast<std::ptrdiff_t>(from),
                       flags.begin() + static_cast<std::ptrdiff_t>(to),
                       [](Quality q) { return (q & quality::kStuck) != 0; });
}

TEST(Standstill, ASpoolThatNeverMovedUnderAMovingCommandIsFlagged) {
  SampleBlock rows = Press(1, 20);
  std::fill(rows.signal[kSpool].begin(), rows.signal[kSpool].end(), 0.1);
  const auto flags = Flags(rows, kSpool);
  EXPECT_GT(Stuck(flags, 0, flags.size()), 0.8 * static_cast<double>(flags.size()));
}

TEST(Standstill, ASpoolThatIsFrozenButForItsNoiseIsFlagged) {
  SampleBlock rows = Press(2, 30);
  std::vector<double>& y = rows.signal[kSpool];
  double noise = 4e-4;
  for (std::size_t k = 5000; k < 10000; ++k) y[k] = 0.3 + (noise = -noise) * static_cast<double>(k % 7) / 4;
  const auto flags = Flags(rows, kSpool);
  EXPECT_EQ(Stuck(flags, 0, 4900), 0);
  EXPECT_GT(Stuck(flags, 5000, 10000), 3500);
  EXPECT_LT(Stuck(flags, 10100, flags.size()), 1);
}

/// The spool follows its command as a valve does, read with a resolution of 1e-6 and next to no noise.
void FollowSmoothly(SampleBlock& rows) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 1e-5);
  double spool = 0;
  for (std::size_t k = 0; k < rows.rows(); ++k) {
    spool += 0.2 * (rows.signal[kCommand][k] / 10 - spool);
    rows.signal[kSpool][k] = std::round((spool + noise(random)) * 1e6) / 1e6;
  }
}

/// A spool whose reading repeats bit for bit for 0.6 s now and then.
std::vector<std::size_t> Freeze(std::vector<double>& y, std::size_t first) {
  constexpr std::size_t kFrozen = 300;
  std::vector<std::size_t> begins;
  for (std::size_t at = first; at + kFrozen < y.size(); at += 2471) {
    std::fill_n(y.begin() + static_cast<std::ptrdiff_t>(at), kFrozen, y[at]);
    begins.push_back(at);
  }
  return begins;
}

TEST(Standstill, ASpoolThatRepeatsItsReadingUnderAMovingCommandIsFlaggedFromItsFirstEqualReadingOn) {
  SampleBlock rows = Press(4, 60);
  FollowSmoothly(rows);
  const std::vector<std::size_t> begins = Freeze(rows.signal[kSpool], 3000);
  ASSERT_GE(begins.size(), 10u);
  const auto flags = Flags(rows, kSpool);
  std::int64_t frozen = 0;
  for (const std::size_t begin : begins) {
    EXPECT_EQ(Stuck(flags, begin, begin + 300), 300) << begin;
    frozen += 300;
  }
  EXPECT_EQ(Stuck(flags, 0, flags.size()), frozen);
}

TEST(Standstill, WhatIsFlaggedDoesNotDependOnTheBlocks) {
  SampleBlock rows = Press(5, 20);
  FollowSmoothly(rows);
  Freeze(rows.signal[kSpool], 3001);
  const auto flags = Flags(rows, kSpool);
  EXPECT_GT(Stuck(flags, 0, flags.size()), 500);
  for (const std::size_t block : {1, 7, 64}) EXPECT_EQ(Flags(rows, kSpool, block), flags) << block;
}

TEST(Standstill, ASpoolThatStandsBecauseItsCommandStandsIsNotFlagged) {
  SampleBlock rows = Press(6, 30);
  std::vector<double>&y = rows.signal[kSpool], &command = rows.signal[kCommand];
  std::mt19937_64 random(6);
  std::normal_distribution<double> noise(0, 0.01);
  for (std::size_t at = 3000; at + 1000 < command.size(); at += 2500)
    std::fill_n(command.begin() + static_cast<std::ptrdiff_t>(at), 600, command[at]);
  double spool = 0;
  for (std::size_t k = 0; k < y.size(); ++k) {
    spool += 0.2 * (command[k] / 10 - spool);
    y[k] = std::round(spool * 1e4) / 1e4;
    command[k] += noise(random);
  }
  const auto flags = Flags(rows, kSpool);
  EXPECT_EQ(Stuck(flags, 0, flags.size()), 0);
}

TEST(Standstill, ACoarseSpoolIsNotFlagged) {
  for (const double step : {1.0 / 2048, 1.0 / 128, 1.0 / 32}) {
    SampleBlock rows = Press(7, 30);
    for (double& y : rows.signal[kSpool]) y = std::round(y / step) * step;
    const auto flags = Flags(rows, kSpool);
    EXPECT_EQ(Stuck(flags, 0, flags.size()), 0) << step;
  }
}

TEST(Standstill, APressureThatIsFrozenButForItsNoiseIsFlaggedFromItsFirstStrokeOn) {
  SampleBlock rows = Press(3, 60);
  std::vector<double>& p = rows.signal[kPressure];
  std::mt19937_64 random(3);
  std::normal_distribution<double> frozen(120e5, 2.2e5);
  for (std::size_t k = 10000; k < 30000; ++k) p[k] = frozen(random);
  const auto flags = Flags(rows, kPressure);
  EXPECT_EQ(Stuck(flags, 0, 9900), 0);
  EXPECT_GT(Stuck(flags, 10000, 30000), 10000);
}

TEST(Standstill, HealthyPressesCarryNoFlag) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const SampleBlock rows = Press(seed);
    for (const Channel channel : {kPressure, kPosition, kSpool, kCommand}) {
      const auto flags = Flags(rows, channel);
      EXPECT_EQ(Stuck(flags, 0, flags.size()), 0) << seed << " " << channel;
      EXPECT_EQ(std::count_if(flags.begin(), flags.end(),
                              [](Quality q) { return (q & quality::kOutOfRange) != 0; }),
                0)
          << seed << " " << channel;
    }
  }
}

}  // namespace
}  // namespace hydroscope
