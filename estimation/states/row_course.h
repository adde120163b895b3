#pragma once

#include "estimation/episode.h"
#include "models/machine.h"

namespace hydroscope {

/// What an input does from a row to the next, over the share of the time between them: it is held, moves evenly,
/// or bends as a cubic.
struct RowCourse {
  double begin = 0, end = 0;
  double bend_begin = 0, bend_end = 0;  ///< a sixth of its second derivative by the share

  double At(double share) const;
  double Slope(double share) const;  ///< by the share
  RowCourse Part(double from, double to) const;
  /// Its rate of change, per second; `period`: s from the row to the next.
  RowCourse Rate(double period) const;
};

/// From a row to the next; after the last row an input stays. Smooth is a cubic through both rows with the mean and the first
/// moment of motion that has nothing above half the sampling rate (cardinal series, Shannon 1949, over the rows near by, which are
/// evenly apart): what states that are slower than rows remember of it is kept to 1e-3 up to 0.4 of the sampling rate. Beyond the
/// ends of the episode it is turned about them.
RowCourse CourseOf(const Episode& episode, int row, int signal, InputHold hold);

}  // namespace hydroscope
