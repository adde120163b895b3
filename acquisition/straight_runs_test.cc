#include "acquisition/straight_runs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace hydroscope {
namespace {

constexpr std::size_t kRows = 8000;

/// A swing with white noise of standard deviation `std` on it, rounded to `resolution` (0: not at all).
std::vector<double> Readings(double std, double resolution = 0) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 1);
  std::vector<double> values(kRows);
  for (std::size_t k = 0; k < kRows; ++k) {
    values[k] = std::sin(0.01 * static_cast<double>(k)) + std * noise(random);
    if (resolution > 0) values[k] = std::round(values[k] / resolution) * resolution;
  }
  return values;
}

/// Readings `from` to `to`, both left out, on the straight line between these two, rounded as the others.
void Draw(std::size_t from, std::size_t to, std::vector<double>& values, double resolution = 0) {
  for (std::size_t k = from + 1; k < to; ++k) {
    values[k] = values[from] +
                (values[to] - values[from]) * static_cast<double>(k - from) / static_cast<double>(to - from);
    if (resolution > 0) values[k] = std::round(values[k] / resolution) * resolution;
  }
}

/// Rows flagged, given in blocks of `rows_at_once`; every row comes out again, in order.
std::vector<std::size_t> Drawn(const std::vector<double>& values, std::size_t rows_at_once) {
  StraightRuns runs(1);
  std::vector<std::size_t> flagged;
  std::size_t out = 0;
  const auto take = [&](const SampleBlock& block) {
    for (std::size_t k = 0; k < block.rows(); ++k, ++out) {
      EXPECT_EQ(block.signal[0][k], values[out]);
      EXPECT_EQ(block.time[k], static_cast<double>(out));
      if ((block.quality[0][k] & quality::kInterpolated) != 0) flagged.push_back(out);
    }
  };
  SampleBlock block;
  for (std::size_t at = 0; at < values.size(); at += rows_at_once) {
    block.Resize(1, std::min(rows_at_once, values.size() - at));
    for (std::size_t k = 0; k < block.rows(); ++k) {
      block.time[k] = static_cast<double>(at + k);
      block.signal[0][k] = values[at + k];
      block.quality[0][k] = quality::kGood;
    }
    runs.Inspect(block);
    take(block);
  }
  runs.Flush(block);
  take(block);
  EXPECT_EQ(out, values.size());
  return flagged;
}

TEST(StraightRuns, FlagsWhatALoggerDrewAndNotTheReadingsAtItsEnds) {
  std::vector<double> values = Readings(0.02);
  EXPECT_TRUE(Drawn(values, 1000).empty());
  Draw(5000, 5009, values);
  EXPECT_EQ(Drawn(values, 1000), (std::vector<std::size_t>{5001, 5002, 5003, 5004, 5005, 5006, 5007, 5008}));
}

TEST(StraightRuns, FlagsThemWhereverABlockEnds) {
  std::vector<double> values = Readings(0.02);
  Draw(3990, 4013, values);
  for (const std::size_t rows : {1000u, 1001u, 571u, 40u}) EXPECT_EQ(Drawn(values, rows).size(), 22u) << rows;
}

/// Noise that is found to be less takes more readings without a bend to be drawn, also of a run whose first ones are given out.
TEST(StraightRuns, FlagsARunThatMustGetLongerAsItGoesOn) {
  constexpr double kResolution = 2e-6;
  const std::vector<double> loud = Readings(0.02, kResolution), calm = Readings(2e-4, kResolution);
  for (std::size_t from = 3990; from < 3998; ++from) {
    std::vector<double> values(loud.begin(), loud.begin() + 4000);
    values.insert(values.end(), calm.begin() + 4000, calm.end());
    Draw(from, 4020, values, kResolution);
    EXPECT_EQ(Drawn(values, 1000).size(), 4019 - from) << from;
  }
}

TEST(StraightRuns, SeesThemThroughRounding) {
  constexpr double kResolution = 1e-3;
  std::vector<double> values = Readings(0.02, kResolution);
  EXPECT_TRUE(Drawn(values, 1000).empty());
  Draw(6000, 6015, values, kResolution);
  const auto drawn = Drawn(values, 1000);
  EXPECT_EQ(drawn.size(), 14u);
}

/// Of a signal without noise, of a command on its ramps and of one that a historian compressed nothing is said: they lie on straight
/// lines by themselves.
TEST(StraightRuns, LeavesWhatIsStraightByItselfAlone) {
  EXPECT_TRUE(Drawn(Readings(0), 1000).empty());
  EXPECT_TRUE(Drawn(Readings(0, 0.01), 1000).empty());
  EXPECT_TRUE(Drawn(Readings(0.003, 0.01), 1000).empty()) << "noise that the resolution hides";
  EXPECT_TRUE(Drawn(Readings(0.02, 0.008), 1000).empty())
      << "noise that shows in a few steps of the resolution";
  std::vector<double> ramps(kRows), compressed = Readings(0.02);
  for (std::size_t k = 0; k < kRows; ++k) ramps[k] = std::min(1.0, 0.05 * static_cast<double>(k % 97));
  for (std::size_t k = 0; k + 11 < kRows; k += 11) Draw(k, k + 11, compressed);
  EXPECT_TRUE(Drawn(ramps, 1000).empty());
  EXPECT_TRUE(Drawn(compressed, 1000).empty());
}

}  // namespace
}  // namespace hydroscope
