#include "workbench/history/stored_change.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace hydroscope {
namespace {

std::vector<double> Noise(std::size_t n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> y(n);
  for (double& v : y) v = normal(random);
  return y;
}

TEST(LevelChange, IsFoundWhereItIs) {
  std::vector<double> y = Noise(40, 1);
  for (std::size_t i = 25; i < y.size(); ++i) y[i] += 6;
  const auto change = FindLevelChange(y, {});
  ASSERT_TRUE(change.has_value());
  EXPECT_EQ(change->at, 25u);
  EXPECT_NEAR(change->after - change->before, 6, 1.5);
}

TEST(LevelChange, IsNotFoundInNoiseInASteadyDriftOrInWhatFollowsTheOil) {
  for (std::uint64_t seed = 0; seed < 300; ++seed)
    EXPECT_FALSE(FindLevelChange(Noise(40, 100 + seed), {})) << seed;
  std::vector<double> drift = Noise(40, 2), oil(40), follows = Noise(40, 3);
  for (std::size_t i = 0; i < drift.size(); ++i) {
    drift[i] += 0.5 * static_cast<double>(i);
    oil[i] = i < 20 ? 300.0 : 310.0;
    follows[i] += oil[i];
  }
  EXPECT_FALSE(FindLevelChange(drift, {}));
  EXPECT_TRUE(FindLevelChange(follows, {}));
  EXPECT_FALSE(FindLevelChange(follows, {oil})) << "two levels of the oil";
}

TEST(LevelChange, NeedsEnoughValues) { EXPECT_FALSE(FindLevelChange({0, 0, 0, 0, 9, 9, 9}, {})); }

TEST(WhatMovesOn, IsFoundInADriftAndInSeveralStepsAndNotInNoiseNorWithTheOil) {
  std::vector<double> drift = Noise(40, 2), steps = Noise(40, 3), oil(40);
  for (std::size_t i = 0; i < drift.size(); ++i) {
    drift[i] += 0.5 * static_cast<double>(i);
    steps[i] += 6.0 * static_cast<double>(i / 10);
    oil[i] = drift[i] + 300;
  }
  for (const auto& values : {drift, steps}) {
    EXPECT_FALSE(FindLevelChange(values, {}));
    const auto ends = FindWhatMovesOn(values, {});
    ASSERT_TRUE(ends.has_value());
    EXPECT_GE(ends->first_end, 3u);
    EXPECT_LE(ends->first_end, 12u);
    EXPECT_GE(ends->last_begin, 28u);
  }
  EXPECT_FALSE(FindWhatMovesOn(drift, {oil}));
  for (std::uint64_t seed = 0; seed < 300; ++seed)
    EXPECT_FALSE(FindWhatMovesOn(Noise(40, 100 + seed), {})) << seed;
}

TEST(Stretch, IsFoundWhereValuesComeBack) {
  std::vector<double> y = Noise(40, 1);
  for (std::size_t i = 15; i < 22; ++i) y[i] += 6;
  EXPECT_FALSE(FindLevelChange(y, {})) << "no place divides them";
  const auto stretch = FindStretch(y, {});
  ASSERT_TRUE(stretch.has_value());
  EXPECT_EQ(stretch->first, 15u);
  EXPECT_EQ(stretch->last, 22u);
  EXPECT_NEAR(stretch->inside - stretch->outside, 6, 1.5);
  EXPECT_FALSE(FindStretch(y, {y})) << "the oil was as warm";
}

TEST(Stretch, IsNotFoundInNoiseInADriftOrInOneStep) {
  for (std::uint64_t seed = 0; seed < 300; ++seed)
    EXPECT_FALSE(FindStretch(Noise(40, 100 + seed), {})) << seed;
  std::vector<double> drift = Noise(40, 2), step = Noise(40, 3);
  for (std::size_t i = 0; i < drift.size(); ++i) {
    drift[i] += 0.5 * static_cast<double>(i);
    step[i] += i < 20 ? 0 : 6;
  }
  EXPECT_FALSE(FindStretch(drift, {}));
  EXPECT_FALSE(FindStretch(step, {}));
}

/// Logarithms of error energy over blocks: `grows` from block 18 on, ever further.
std::vector<double> Errors(std::uint64_t seed, double grows) {
  std::vector<double> errors = Noise(34, seed);
  for (std::size_t i = 0; i < errors.size(); ++i)
    errors[i] = 0.1 * errors[i] + (i < 18 ? 0.0 : grows * (1 + 0.1 * static_cast<double>(i - 18)));
  return errors;
}

TEST(ErrorGrowth, IsFoundWhereItBeginsThoughItGoesOnAsALine) {
  const std::vector<double> errors = Errors(1, 0.6);
  EXPECT_FALSE(FindLevelChange(errors, {})) << "a line does nearly as well";
  const auto growth = FindErrorGrowth(errors, {});
  ASSERT_TRUE(growth.has_value());
  EXPECT_NEAR(static_cast<double>(growth->at), 18, 1);
}

TEST(ErrorGrowth, IsNotFoundWhereAModelErrsAlikeErrsLessOrErrsWithTheOilOrTheSpeed) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) EXPECT_FALSE(FindErrorGrowth(Errors(seed, 0), {})) << seed;
  EXPECT_FALSE(FindErrorGrowth(Errors(1, -0.6), {}));
  EXPECT_FALSE(FindErrorGrowth(Errors(1, 0.05), {})) << "within what a model may err";
  std::vector<double> speed(34);
  for (std::size_t i = 0; i < speed.size(); ++i) speed[i] = Errors(2, 0.6)[i];
  EXPECT_FALSE(FindErrorGrowth(Errors(1, 0.6), {std::vector<double>(34, 303), speed}));
}

TEST(StoredChange, LimitsSignalsAndSlowDriftsTellNoChange) {
  AlarmState alarm;
  alarm.id = "internal_leakage";
  alarm.active = true;
  alarm.first_stroke = 40;
  EXPECT_TRUE(TellsAChange(alarm));
  for (const char* id : {"slow_K", "K.warn_low", "doubtful_reference"}) {
    AlarmState other = alarm;
    other.id = id;
    EXPECT_FALSE(TellsAChange(other)) << id;
  }
  alarm.active = false;
  EXPECT_FALSE(TellsAChange(alarm));
}

}  // namespace
}  // namespace hydroscope
