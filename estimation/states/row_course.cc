#include "estimation/states/row_course.h"

#include <algorithm>
#include <numbers>

namespace hydroscope {
namespace {

/// A sixth of the spline's second derivative at a row: what rows on either side give to it falls by kPole from one to the next.
double BendAt(const Episode& episode, int row, int signal) {
  constexpr int kReach = 12;  // rows; what is further away gives less than 1e-6 of it
  constexpr double kPole = std::numbers::sqrt3 - 2, kNear = 1 / (2 * std::numbers::sqrt3);
  const int last = episode.rows() - 1;
  const double here = episode.signal(row, signal);
  double sum = 0, weight = -6 * kNear;
  for (int away = 1; away <= kReach; ++away) {
    weight *= kPole;
    // Beyond the ends the course is turned about the end: no bend there.
    const auto from_here = [&](int k) {
      if (k < 0)
        return 2 * (episode.signal(0, signal) - here) - (episode.signal(std::min(-k, last), signal) - here);
      if (k > last)
        return 2 * (episode.signal(last, signal) - here) -
               (episode.signal(std::max(2 * last - k, 0), signal) - here);
      return episode.signal(k, signal) - here;
    };
    sum += weight * (from_here(row - away) + from_here(row + away));
  }
  return sum;
}

/// What a cubic adds to a straight line by a bend at its beginning, `rest` = 1 - share; at its end with the share.
double Bent(double rest) { return rest * (rest * rest - 1); }

}  // namespace

double RowCourse::At(double share) const {
  return begin + share * (end - begin) + bend_begin * Bent(1 - share) + bend_end * Bent(share);
}

double RowCourse::Slope(double share) const {
  const double rest = 1 - share;
  return end - begin + bend_begin * (1 - 3 * rest * rest) + bend_end * (3 * share * share - 1);
}

RowCourse RowCourse::Part(double from, double to) const {
  const double square = (to - from) * (to - from);
  const auto bend = [&](double share) { return square * ((1 - share) * bend_begin + share * bend_end); };
  return {At(from), At(to), bend(from), bend(to)};
}

RowCourse RowCourse::Rate(double period) const {
  const double bend = (bend_end - bend_begin) / period;
  return {Slope(0) / period, Slope(1) / period, bend, bend};
}

RowCourse CourseOf(const Episode& episode, int row, int signal, InputHold hold) {
  RowCourse course;
  course.begin = course.end = episode.signal(row, signal);
  if (hold == InputHold::kZero || row + 1 >= episode.rows()) return course;
  course.end = episode.signal(row + 1, signal);
  if (hold != InputHold::kSmooth) return course;
  course.bend_begin = BendAt(episode, row, signal);
  course.bend_end = BendAt(episode, row + 1, signal);
  return course;
}

}  // namespace hydroscope
