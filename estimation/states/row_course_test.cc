#include "estimation/states/row_course.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace hydroscope {
namespace {

Episode Sine(double cycles_a_row, int rows) {
  Episode episode;
  episode.signal.resize(rows, 1);
  for (int row = 0; row < rows; ++row) {
    episode.time.push_back(row);
    episode.signal(row, 0) = std::cos(2 * std::numbers::pi * cycles_a_row * row + 0.4);
  }
  return episode;
}

/// An anti-aliasing filter lets through what is up to 0.4 of the sampling rate; states add up the mean from row to row.
TEST(RowCourse, SmoothMotionKeepsItsMeanUpToFourTenthsOfTheSamplingRate) {
  for (const double cycles : {0.02, 0.1, 0.2, 0.33, 0.4}) {
    const Episode episode = Sine(cycles, 60);
    const double rate = 2 * std::numbers::pi * cycles;
    for (int row = 20; row < 40; ++row) {
      const RowCourse course = CourseOf(episode, row, 0, InputHold::kSmooth);
      EXPECT_NEAR(course.At(0), episode.signal(row, 0), 1e-12);
      EXPECT_NEAR(course.At(1), episode.signal(row + 1, 0), 1e-12);
      double mean = 0;
      for (int k = 0; k < 100; ++k) mean += course.At((k + 0.5) / 100) / 100;
      const double truth = (std::sin(rate * (row + 1) + 0.4) - std::sin(rate * row + 0.4)) / rate;
      EXPECT_NEAR(mean, truth, 1e-3) << cycles;
    }
  }
}

TEST(RowCourse, SmoothMotionThatIsStraightStaysStraightToTheEnds) {
  Episode episode;
  episode.signal.resize(30, 1);
  for (int row = 0; row < 30; ++row) {
    episode.time.push_back(row);
    episode.signal(row, 0) = 5 + 0.3 * row;
  }
  for (const int row : {0, 3, 15, 28})
    EXPECT_NEAR(CourseOf(episode, row, 0, InputHold::kSmooth).At(0.3), 5 + 0.3 * (row + 0.3), 1e-9) << row;
}

}  // namespace
}  // namespace hydroscope
