#include "estimation/states/row_course.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace hydroscope {
namespace {

/// What the rows near by give to the mean over the time to the next row, and to the first moment about its middle, of motion that
/// has nothing above half the sampling rate: cardinal series under a Kaiser window. What is straight stays straight.
class BandLimited {
 public:
  static constexpr int kReach = 12;  ///< rows on either side

  BandLimited() {
    constexpr double kShape = 7;  // of the window: what is below 0.4 of the sampling rate is kept to 1e-3
    constexpr int kPoints = 1000;
    double sum = 0, lever = 0;
    for (int k = 1 - kReach; k <= kReach; ++k)
      for (int point = 0; point < kPoints; ++point) {
        const double share = (point + 0.5) / kPoints, away = share - k, within = away / kReach;
        const double sine = std::numbers::pi * away;
        const double weight = std::sin(sine) / sine *
                              std::cyl_bessel_i(0, kShape * std::sqrt(std::max(0.0, 1 - within * within))) /
                              std::cyl_bessel_i(0, kShape) / kPoints;
        mean_[At(k)] += weight;
        moment_[At(k)] += weight * (share - 0.5);
      }
    for (int k = 1 - kReach; k <= kReach; ++k) {
      sum += mean_[At(k)];
      lever += k * moment_[At(k)];
    }
    for (double& weight : mean_) weight /= sum;
    for (double& weight : moment_) weight /= 12 * lever;
  }

  double mean(int row) const { return mean_[At(row)]; }  ///< row: from the one where the time begins
  double moment(int row) const { return moment_[At(row)]; }

 private:
  static std::size_t At(int row) { return static_cast<std::size_t>(row + kReach - 1); }
  std::array<double, 2 * kReach> mean_{}, moment_{};
};

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
  static const BandLimited weights;
  const int last = episode.rows() - 1;
  const double here = course.begin;
  // Beyond the ends the course is turned about the end.
  const auto from_here = [&](int k) {
    if (k < 0)
      return 2 * (episode.signal(0, signal) - here) - (episode.signal(std::min(-k, last), signal) - here);
    if (k > last)
      return 2 * (episode.signal(last, signal) - here) -
             (episode.signal(std::max(2 * last - k, 0), signal) - here);
    return episode.signal(k, signal) - here;
  };
  double mean = 0, moment = 0;
  for (int away = 1 - BandLimited::kReach; away <= BandLimited::kReach; ++away) {
    const double change = from_here(row + away);
    mean += weights.mean(away) * change;
    moment += weights.moment(away) * change;
  }
  const double rise = course.end - course.begin;
  // Bends add -1/4 of their sum to the mean, and 1/120 of their difference to the moment.
  const double sum = 4 * (rise / 2 - mean), difference = 120 * (moment - rise / 12);
  course.bend_begin = (sum + difference) / 2;
  course.bend_end = (sum - difference) / 2;
  return course;
}

}  // namespace hydroscope
