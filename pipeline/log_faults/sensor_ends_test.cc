#include "pipeline/log_faults/sensor_ends.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace hydroscope {
namespace {

Machine Tank(const std::string& limit = "", const std::string& of_signal = "") {
  const auto machine = ParseMachine(
      "[signals]\nq = { column = \"q\", unit = \"1\" }\n"
      "level = { column = \"level\", unit = \"V\"" +
          of_signal + " }\n[states]\nh = { ddt = \"k*q\", unit = \"V\"" + limit +
          " }\n[outputs]\nlevel = \"h\"\n"
          "[parameters]\nk = { start = 1, min = 0, max = 2 }\n",
      "tank.toml");
  EXPECT_TRUE(machine) << machine.error().text;
  return *machine;
}

/// A level that moves by many times its noise from row to row, as of slow tanks, read in steps of 2.4 mV up to `end`.
SampleBlock Levels(double end, double noise) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  SampleBlock rows;
  rows.Resize(2, 1000);
  for (std::size_t k = 0; k < rows.rows(); ++k) {
    const double t = static_cast<double>(k);
    const double level = 7 + 4 * std::sin(t / 31) * std::sin(t / 67 + 1) + noise * normal(random);
    rows.time[k] = 4 * t;
    rows.signal[1][k] = std::round(std::min(level, end) / 0.0024) * 0.0024;
  }
  return rows;
}

std::int64_t Flagged(const SampleBlock& rows) {
  return std::count(rows.quality[1].begin(), rows.quality[1].end(), quality::kOutOfRange);
}

TEST(SensorEnds, ReadingsThatPileUpAtTheHighestAreLeftOutThoughNoNoiseTurnsThemBack) {
  for (const double noise : {0.0, 0.02}) {
    SampleBlock rows = Levels(9.6, noise);
    const auto piled = std::count(rows.signal[1].begin(), rows.signal[1].end(), 4000 * 0.0024);
    ASSERT_GT(piled, 50);
    const auto ends = FlagSensorEnds(Tank(), {1}, rows);
    ASSERT_EQ(ends.size(), 1u);
    EXPECT_TRUE(ends[0].upper);
    EXPECT_NEAR(ends[0].at, 9.6, 1e-9);
    EXPECT_EQ(Flagged(rows), piled);
    EXPECT_THAT(SensorEndText(ends[0], Tank()).english,
                testing::HasSubstr("level stands at its highest reading, 9.6 V"));
  }
}

TEST(SensorEnds, WhereNothingIsCutOffThereIsNone) {
  for (const double noise : {0.0, 0.02}) {
    SampleBlock rows = Levels(100, noise);
    EXPECT_TRUE(FlagSensorEnds(Tank(), {1}, rows).empty());
    EXPECT_EQ(Flagged(rows), 0);
  }
}

TEST(SensorEnds, WhatTheFileSaysStopsThereIsNone) {
  SampleBlock rows = Levels(9.6, 0);
  EXPECT_TRUE(FlagSensorEnds(Tank(", max = 9.6"), {1}, rows).empty());
  EXPECT_TRUE(FlagSensorEnds(Tank("", ", stuck_time = 0"), {1}, rows).empty());
}

TEST(SensorEnds, WhatSettlesAtAValueIsNoEnd) {
  SampleBlock rows;
  rows.Resize(2, 1000);
  for (std::size_t k = 0; k < rows.rows();
       ++k)  // steps answered by a first-order lag, until the converter sees no change
    rows.signal[1][k] = std::round((5 - 5 * std::exp(-static_cast<double>(k % 250) / 20)) / 0.01) * 0.01;
  EXPECT_TRUE(FlagSensorEnds(Tank(), {1}, rows).empty());
}

/// A level that comes to the end as slowly as it goes away from there. Noise of more than a converter's step tells it from one that
/// settles: at rest no reading would repeat.
TEST(SensorEnds, WhatIsCutOffGentlyIsOneWhereNoiseWouldScatterItAtRest) {
  for (const double noise : {0.01, 0.0}) {
    std::mt19937 random(4);
    std::normal_distribution<double> normal;
    SampleBlock rows;
    rows.Resize(2, 1000);
    for (std::size_t k = 0; k < rows.rows(); ++k) {
      const double swing = std::sin(static_cast<double>(k) / 60);
      rows.signal[1][k] = std::min(5.0, 5.05 * (1 - std::pow(1 - swing, 3)) + noise * normal(random));
    }
    EXPECT_EQ(FlagSensorEnds(Tank(), {1}, rows).size(), noise > 0 ? 1u : 0u) << noise;
  }
}

TEST(SensorEnds, OfAnInputItIsSaidWhatEpisodesGoWithoutAndHowToKeepIt) {
  SampleBlock rows = Levels(9.6, 0.02);
  std::swap(rows.signal[0], rows.signal[1]);
  for (std::size_t k = 0; k < rows.rows(); ++k)
    if (rows.signal[0][k] == 4000 * 0.0024) rows.quality[0][k] = quality::kOutOfRange;
  rows.quality[0][0] = quality::kOutOfRange;  // a reading by itself is no end
  const auto ends = FlaggedInputEnds(Tank(), {0}, rows);
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_TRUE(ends[0].upper);
  const Told text = InputEndText(ends[0], Tank());
  EXPECT_THAT(text.english, testing::HasSubstr("q stands at its highest reading, 9.6"));
  EXPECT_THAT(text.english, testing::HasSubstr("stuck_time = 0"));
}

}  // namespace
}  // namespace hydroscope
