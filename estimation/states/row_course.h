#pragma once

#include "estimation/episode.h"
#include "models/machine.h"

namespace hydroscope {

/// What an input does from a row to the next, over the share of the time between them: it is held, moves evenly, or bends as a
/// cubic spline through the rows does.
struct RowCourse {
  double begin = 0, end = 0;
  double bend_begin = 0, bend_end = 0;  ///< a sixth of its second derivative by the share

  double At(double share) const;
  double Slope(double share) const;  ///< by the share
  RowCourse Part(double from, double to) const;
  /// Its rate of change, per second; `period`: s from the row to the next.
  RowCourse Rate(double period) const;
};

/// From a row to the next; after the last row an input stays. The spline is that of rows which are evenly apart (cardinal
/// cubic spline, Schoenberg 1973), taken over the rows near by and straight beyond the ends of the episode: of motion at
/// a fifth of the sampling rate it loses 0.5 %, where straight lines lose 12 %.
RowCourse CourseOf(const Episode& episode, int row, int signal, InputHold hold);

}  // namespace hydroscope
