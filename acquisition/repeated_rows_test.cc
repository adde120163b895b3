#include "acquisition/repeated_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace hydroscope {
namespace {

constexpr std::size_t kChannels = 3;

/// `rows` rows of noise on a slow swing; with `std` 0 the swing alone.
SampleBlock NoisyRows(std::size_t rows, double std) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 1);
  SampleBlock block;
  block.Resize(kChannels, rows);
  for (std::size_t c = 0; c < kChannels; ++c)
    for (std::size_t k = 0; k < rows; ++k)
      block.signal[c][k] =
          std::sin(2 * 3.14159265358979 * static_cast<double>(k % 500) / 500) + std * noise(random);
  return block;
}

/// Rows [`from`, `from` + `count`) once more, `to` rows from the beginning.
void Copy(std::size_t from, std::size_t to, std::size_t count, SampleBlock& block) {
  for (auto& values : block.signal)
    for (std::size_t k = 0; k < count; ++k) values[to + k] = values[from + k];
}

/// Flagged rows, given in blocks of `rows_at_once`.
std::vector<std::size_t> Flagged(const SampleBlock& all, std::size_t rows_at_once) {
  RepeatedRows repeated(kChannels);
  std::vector<std::size_t> flagged;
  std::size_t seen = 0;
  const auto take = [&](const SampleBlock& block) {
    for (std::size_t k = 0; k < block.rows(); ++k, ++seen)
      if ((block.quality[kChannels - 1][k] & quality::kDuplicate) != 0) flagged.push_back(seen);
  };
  SampleBlock block;
  for (std::size_t at = 0; at < all.rows(); at += rows_at_once) {
    const std::size_t rows = std::min(rows_at_once, all.rows() - at);
    block = {};
    block.Resize(kChannels, rows);
    for (std::size_t c = 0; c < kChannels; ++c)
      std::copy_n(all.signal[c].begin() + static_cast<std::ptrdiff_t>(at), rows, block.signal[c].begin());
    repeated.Inspect(block);
    take(block);
  }
  repeated.Flush(block);
  take(block);
  EXPECT_EQ(seen, all.rows());
  EXPECT_EQ(repeated.copies(), static_cast<std::int64_t>(flagged.size()));
  return flagged;
}

TEST(RepeatedRows, FlagsABlockThatWasWrittenTwice) {
  SampleBlock rows = NoisyRows(4000, 0.1);
  EXPECT_TRUE(Flagged(rows, 4000).empty());
  Copy(1000, 1300, 300, rows);
  const auto flagged = Flagged(rows, 4000);
  ASSERT_FALSE(flagged.empty());
  EXPECT_EQ(flagged.front(), 1300u);
  EXPECT_EQ(flagged.back(), 1599u);
  EXPECT_EQ(flagged.size(), 300u);
}

TEST(RepeatedRows, DoesNotDependOnTheBlocks) {
  SampleBlock rows = NoisyRows(4000, 0.1);
  Copy(0, 2000, 2000, rows);
  const auto flagged = Flagged(rows, 4000);
  EXPECT_GT(flagged.size(), 1700u);
  EXPECT_EQ(Flagged(rows, 7), flagged);
}

TEST(RepeatedRows, RemembersTheLastQuarterOfAMillionRowsOfALongLog) {
  SampleBlock rows = NoisyRows(600'000, 0.1);
  Copy(320'000, 560'000, 100, rows);  // both behind the rows that are remembered at first
  Copy(200'000, 590'000, 100, rows);  // forgotten by then
  const auto flagged = Flagged(rows, 1024);
  ASSERT_GT(flagged.size(), 90u);  // a row whose hash another has taken the place of is no beginning
  EXPECT_GE(flagged.front(), 560'000u);
  EXPECT_EQ(flagged.back(), 560'099u);
}

TEST(RepeatedRows, LeavesAMachineWithoutNoiseAlone) {
  EXPECT_TRUE(Flagged(NoisyRows(4000, 0), 4000).empty());
}

TEST(RepeatedRows, LeavesACoarseSensorAtRestAlone) {
  SampleBlock rows = NoisyRows(20000, 0.1);
  for (auto& values : rows.signal)
    for (double& x : values) x = std::round(0.5 * x / 0.1) * 0.1;
  EXPECT_TRUE(Flagged(rows, 20000).empty());
}

}  // namespace
}  // namespace hydroscope
