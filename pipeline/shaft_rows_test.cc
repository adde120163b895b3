#include "pipeline/shaft_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pipeline/shaft_ripple.h"

namespace hydroscope {
namespace {

constexpr double kPeriod = 2.5e-4;

/// Signals: speed of a shaft that speeds up, an input that ramps, an output that steps at half of the time, with a ripple.
Episode Rippled(double ripple) {
  constexpr int kRows = 8000;
  Episode episode;
  episode.signal.resize(kRows, 3);
  double angle = 0;
  for (int row = 0; row < kRows; ++row) {
    const double t = row * kPeriod, speed = 250 + 80 * t;
    episode.time.push_back(t);
    const double repeats = std::sin(9 * angle) + 0.3 * std::sin(18 * angle + 1) + 0.2 * std::cos(angle);
    episode.signal.row(row) << speed, 1 + 2 * t, (t > 1 ? 5.0 : 1.0) + ripple * repeats;
    angle += kPeriod * (speed + 0.5 * 80 * kPeriod);
  }
  return episode;
}

Episode Taken(const Episode& episode) { return AtShaftAngles(episode, 0, {2}, InputHold::kLinear); }

TEST(ShaftRows, TakesOutWhatRepeatsWithTheShaftWhileItsSpeedChanges) {
  const Episode with = Taken(Rippled(1)), without = Taken(Rippled(0));
  ASSERT_EQ(with.rows(), without.rows());
  double energy = 0;
  int readings = 0;
  for (int row = 0; row < with.rows(); ++row) {
    const double left = with.signal(row, 2) - without.signal(row, 2);
    EXPECT_EQ(std::isfinite(left), row > 0 && row % kRowsPerRevolution == 0) << row;
    if (!std::isfinite(left)) continue;
    energy += left * left;
    ++readings;
  }
  EXPECT_GT(readings, 100);
  EXPECT_LT(std::sqrt(energy / readings), 0.01) << "of a ripple of 0.75 rms";
}

TEST(ShaftRows, LeavesAStepWithinTheRevolutionItIsIn) {
  const Episode taken = Taken(Rippled(0));
  for (int row = kRowsPerRevolution; row < taken.rows(); row += kRowsPerRevolution) {
    const double begin = taken.time[static_cast<std::size_t>(row - kRowsPerRevolution)],
                 end = taken.time[static_cast<std::size_t>(row)];
    if (end < 1 - kPeriod) {
      EXPECT_NEAR(taken.signal(row, 2), 1, 1e-9);
    }
    if (begin > 1 + kPeriod) {
      EXPECT_NEAR(taken.signal(row, 2), 5, 1e-9);
    }
    if (begin < 1 && end > 1) {
      EXPECT_NEAR(taken.signal(row, 2), 1 + 4 * (end - 1) / (end - begin), 0.05) << "its mean over the angle";
    }
  }
}

TEST(ShaftRows, LeaveNoMeanOfARippleThatGrowsWithinARevolution) {
  Episode episode = Rippled(1);
  const Episode still = Rippled(0);
  const auto grown = [](double t) { return 1 + 0.5 * std::sin(8 * t); };
  for (int row = 0; row < episode.rows(); ++row) {
    const double ripple = episode.signal(row, 2) - still.signal(row, 2);
    episode.signal(row, 2) = 1 + ripple * grown(row * kPeriod);
  }
  const Episode taken = Taken(episode);
  double energy = 0, readings = 0;
  for (int row = 10 * kRowsPerRevolution; row < taken.rows() - 10 * kRowsPerRevolution;
       row += kRowsPerRevolution) {
    energy += std::pow(taken.signal(row, 2) - 1, 2);
    readings += 1;
  }
  EXPECT_LT(std::sqrt(energy / readings), 1e-3);
}

/// Orders of a shaft of 400 rad/s in readings of 200 bar that step by 5 bar now and then; bar.
ShaftRipple RippleOfStepped(double mean, const std::vector<double>& turns) {
  std::vector<double> readings;
  for (const double turn : turns)
    readings.push_back(mean + (std::fmod(turn, 40) < 20.3 ? 0.0 : 5.0) +
                       0.5 * std::sin(9 * 2 * std::numbers::pi * turn) +
                       0.1 * std::cos(2 * std::numbers::pi * turn));
  return {turns, readings};
}

TEST(ShaftRipple, OfHalfABarIsFoundOn200BarThatStep) {
  std::vector<double> turns;
  for (int row = 0; row < 24'000; ++row) turns.push_back(400 * kPeriod * row / (2 * std::numbers::pi));
  const ShaftRipple ripple = RippleOfStepped(200, turns);
  ASSERT_FALSE(ripple.empty());
  double energy = 0, rows = 0;
  for (std::size_t row = 1000; row + 1000 < turns.size(); ++row) {
    energy += std::pow(ripple.At(turns[row]) - 0.5 * std::sin(9 * 2 * std::numbers::pi * turns[row]) -
                           0.1 * std::cos(2 * std::numbers::pi * turns[row]),
                       2);
    rows += 1;
  }
  EXPECT_LT(std::sqrt(energy / rows), 0.03) << "bar, of a ripple of 0.36 rms";
}

/// A ripple whose size goes from 1 to 2 and back within less than two revolutions, on readings of 200 that step with it.
TEST(ShaftRipple, IsFollowedWhileItsSizeChangesWithinARevolution) {
  const auto size = [](double turn) {
    const double beyond = std::fmod(turn, 30) - 20.3;
    return beyond < 0 ? 1 : 1 + std::exp(-beyond) * std::min(1.0, 5 * beyond);
  };
  const auto shape = [](double turn) {
    return std::sin(9 * 2 * std::numbers::pi * turn) + 0.4 * std::cos(2 * std::numbers::pi * turn);
  };
  std::vector<double> turns, readings;
  for (int row = 0; row < 24'000; ++row) {
    turns.push_back(400 * kPeriod * row / (2 * std::numbers::pi));
    readings.push_back(200 + size(turns.back()) * (3 + shape(turns.back())));
  }
  const ShaftRipple ripple(turns, readings);
  double energy = 0, rows = 0;
  for (std::size_t row = 1000; row + 1000 < turns.size(); ++row) {
    energy += std::pow(ripple.At(turns[row]) - size(turns[row]) * shape(turns[row]), 2);
    rows += 1;
  }
  EXPECT_LT(std::sqrt(energy / rows), 0.025) << "of a ripple of 0.9 rms";
}

TEST(ShaftRows, KeepTheSlowRippleOfOutputsAsLinesBetweenRows) {
  const Episode taken = Taken(Rippled(1));
  ASSERT_EQ(taken.ripple.rows(), taken.rows());
  EXPECT_EQ(taken.ripple.col(0).norm(), 0) << "of an input nothing is taken out";
  double product = 0, energy = 0;
  for (int row = 0; row < taken.rows(); ++row) {
    const double order = std::cos(2 * std::numbers::pi * row / kRowsPerRevolution);
    product += taken.ripple(row, 2) * order;
    energy += order * order;
  }
  EXPECT_NEAR(product / energy, 0.2 / 0.95, 0.005) << "lines between eight rows lose 5 % of it";
}

TEST(ShaftRows, AreTwiceAsManyWhereSeveralOutputsTellOfThem) {
  const Episode episode = Rippled(0);
  EXPECT_EQ(AtShaftAngles(episode, 0, {1, 2}, InputHold::kLinear).mean_rows, 2 * Taken(episode).mean_rows);
}

TEST(ShaftRows, KeepsInputsThatMoveEvenly) {
  const Episode taken = Taken(Rippled(1));
  for (int row = 0; row < taken.rows(); ++row)
    EXPECT_NEAR(taken.signal(row, 1), 1 + 2 * taken.time[static_cast<std::size_t>(row)], 1e-9);
}

TEST(ShaftRows, HasNoReadingOfARevolutionInWhichOneIsMissing) {
  Episode episode = Rippled(0);
  episode.signal(4000, 2) = std::numeric_limits<double>::quiet_NaN();
  const Episode whole = Taken(Rippled(0)), holed = Taken(episode);
  int lost = 0;
  for (int row = kRowsPerRevolution; row < whole.rows(); row += kRowsPerRevolution)
    lost += std::isfinite(whole.signal(row, 2)) && !std::isfinite(holed.signal(row, 2));
  EXPECT_GE(lost, 1);
  EXPECT_LE(lost, 2);
}

TEST(ShaftRows, CountsRowsOfARevolution) {
  Episode episode;
  episode.signal.resize(1000, 1);
  for (int row = 0; row < 1000; ++row) {
    episode.time.push_back(row * 1e-3);
    episode.signal(row, 0) = 2 * std::numbers::pi * 25;
  }
  EXPECT_NEAR(RowsPerRevolution(episode, 0), 40, 0.1);
}

}  // namespace
}  // namespace hydroscope
