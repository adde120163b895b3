#include "acquisition/standing_output.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "acquisition/quality_monitor.h"

namespace hydroscope {
namespace {

constexpr double kRowPeriod = 0.001;

Machine TestCylinder() {
  Machine machine;
  machine.model = "test_cylinder";
  for (const char* name : {"z_set", "I_v", "z"}) {
    SignalSpec spec;
    spec.name = name;
    if (spec.name != "z") spec.stuck_time = 0;
    machine.signals.push_back(spec);
  }
  return machine;
}

/// A rod that follows its set point at half its size, in steps of 0.1 um and as smoothly as that moves; m. From 2 s on the set point
/// is `later` times as large.
SampleBlock Rows(int rows, double later = 1) {
  constexpr double kSize = 3e-4, kStep = 1e-7;
  SampleBlock block;
  block.Resize(3, static_cast<std::size_t>(rows));
  for (int k = 0; k < rows; ++k) {
    const auto row = static_cast<std::size_t>(k);
    const double t = k * kRowPeriod;
    const double set = kSize * (std::sin(140 * t) + std::sin(191 * t + 1)) * (k < 2000 ? 1 : later);
    block.time[row] = t;
    block.signal[0][row] = set;
    block.signal[1][row] = 0;
    block.signal[2][row] = kStep * std::round(0.5 * set / kStep);
  }
  return block;
}

std::ptrdiff_t Stuck(const SampleBlock& rows, std::size_t block_rows = 400) {
  QualityMonitor monitor(TestCylinder(), kRowPeriod);
  std::ptrdiff_t stuck = 0;
  const auto count = [&](const SampleBlock& block) {
    stuck += std::ranges::count_if(block.quality[2], [](Quality q) { return (q & quality::kStuck) != 0; });
  };
  SampleBlock block;
  for (std::size_t at = 0; at < rows.rows(); at += block_rows) {
    const std::size_t count_of = std::min(block_rows, rows.rows() - at);
    block.Resize(3, count_of);
    for (std::size_t s = 0; s < 3; ++s) {
      std::copy_n(rows.signal[s].begin() + static_cast<std::ptrdiff_t>(at), count_of,
                  block.signal[s].begin());
      std::ranges::fill(block.quality[s], quality::kGood);
    }
    std::copy_n(rows.time.begin() + static_cast<std::ptrdiff_t>(at), count_of, block.time.begin());
    monitor.Inspect(block);
    count(block);
  }
  monitor.Flush(block);
  count(block);
  return stuck;
}

TEST(StandingOutput, RepeatsOneReadingWhileItsSetPointMoves) {
  SampleBlock rows = Rows(5000);
  EXPECT_EQ(Stuck(rows), 0);
  std::fill_n(rows.signal[2].begin() + 3000, 1000, rows.signal[2][2999]);
  for (const std::size_t block_rows : {7u, 400u, 5000u})
    EXPECT_EQ(Stuck(rows, block_rows), 1000) << block_rows;
}

TEST(StandingOutput, OneThatRestsWithItsSetPointDoesNot) {
  EXPECT_EQ(Stuck(Rows(5000, 0)), 0);
  // Nor one that begins to move again with it.
  SampleBlock rows = Rows(5000);
  for (std::size_t k = 3000; k < 4000; ++k)
    for (const std::size_t s : {0u, 2u}) rows.signal[s][k] = rows.signal[s][2999];
  EXPECT_EQ(Stuck(rows), 0);
}

TEST(StandingOutput, OneOfCoarseStepsDoesNotWhileItsSetPointMovesByLess) {
  SampleBlock rows = Rows(5000, 0.0005);
  for (std::size_t k = 2000; k < 5000; ++k) rows.signal[2][k] = 0;
  EXPECT_EQ(Stuck(rows), 0);
}

}  // namespace
}  // namespace hydroscope
