#include "pipeline/shaft_rows.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/contains.h"
#include "pipeline/shaft_ripple.h"

namespace hydroscope {
namespace {

/// Angle of the shaft at each row, in turns. The speed may be negative, its readings moving evenly in between.
std::vector<double> AnglesOf(const Episode& episode, int speed) {
  constexpr double kPerRadian = 1 / (2 * std::numbers::pi);
  std::vector<double> angle = {0};
  for (int row = 1; row < episode.rows(); ++row) {
    const auto at = static_cast<std::size_t>(row);
    const double mean = 0.5 * (episode.signal(row - 1, speed) + episode.signal(row, speed));
    angle.push_back(angle.back() + kPerRadian * std::abs(mean) * (episode.time[at] - episode.time[at - 1]));
  }
  return angle;
}

/// Integral of a signal, even between rows, over the time from the first row to each.
std::vector<double> IntegralOf(const Episode& episode, int signal) {
  std::vector<double> integral = {0};
  for (int row = 1; row < episode.rows(); ++row) {
    const auto at = static_cast<std::size_t>(row);
    integral.push_back(integral.back() + 0.5 * (episode.time[at] - episode.time[at - 1]) *
                                             (episode.signal(row - 1, signal) + episode.signal(row, signal)));
  }
  return integral;
}

/// Where a new row lies between two of the log.
struct Place {
  int row = 0;       ///< that it follows
  double share = 0;  ///< of the way to the next one
  double time = 0;
};

/// At equal angles, `rows` of them per turn.
std::vector<Place> PlacesOf(const Episode& episode, const std::vector<double>& turns, int rows) {
  std::vector<Place> places;
  int row = 0;
  for (int k = 0; k <= static_cast<int>(rows * turns.back()); ++k) {
    while (row + 2 < episode.rows() && rows * turns[static_cast<std::size_t>(row) + 1] < k) ++row;
    const auto at = static_cast<std::size_t>(row);
    const double share =
        turns[at + 1] > turns[at]
            ? std::clamp((k - rows * turns[at]) / (rows * (turns[at + 1] - turns[at])), 0.0, 1.0)
            : 0.0;
    places.push_back({row, share, episode.time[at] + share * (episode.time[at + 1] - episode.time[at])});
  }
  return places;
}

double IntegralAt(const Episode& episode, int signal, const std::vector<double>& integral, const Place& p) {
  const auto at = static_cast<std::size_t>(p.row);
  const double period = episode.time[at + 1] - episode.time[at], from = episode.signal(p.row, signal),
               rise = episode.signal(p.row + 1, signal) - from;
  return integral[at] + period * p.share * (from + 0.5 * p.share * rise);
}

/// Levels between the new rows.
void TakeLevels(const Episode& episode, int signal, const std::vector<Place>& places, Episode& out) {
  const std::vector<double> integral = IntegralOf(episode, signal);
  for (std::size_t k = 0; k + 1 < places.size(); ++k)
    out.signal(static_cast<Eigen::Index>(k), signal) = (IntegralAt(episode, signal, integral, places[k + 1]) -
                                                        IntegralAt(episode, signal, integral, places[k])) /
                                                       (places[k + 1].time - places[k].time);
  out.signal(out.rows() - 1, signal) = out.signal(out.rows() - 2, signal);
}

/// The polygon over the new rows that lies closest to the readings: normal equations of hat functions, solved from both ends.
void TakePolygon(const Episode& episode, int signal, const std::vector<Place>& places, Episode& out) {
  const std::size_t count = places.size();
  std::vector<double> diagonal(count, 0.0), next(count, 0.0), right(count, 0.0);
  std::size_t k = 0;
  for (int row = 0; row < episode.rows(); ++row) {
    const double t = episode.time[row], y = episode.signal(row, signal);
    if (t > places.back().time) break;
    while (k + 2 < count && places[k + 1].time < t) ++k;
    const double b = (t - places[k].time) / (places[k + 1].time - places[k].time), a = 1 - b;
    diagonal[k] += a * a;
    diagonal[k + 1] += b * b;
    next[k] += a * b;
    right[k] += a * y;
    right[k + 1] += b * y;
  }
  for (std::size_t i = 1; i < count; ++i) {
    const double factor = diagonal[i - 1] > 0 ? next[i - 1] / diagonal[i - 1] : 0.0;
    diagonal[i] -= factor * next[i - 1];
    right[i] -= factor * right[i - 1];
  }
  double after = 0;
  for (std::size_t i = count; i-- > 0;) {
    after = (right[i] - next[i] * after) / std::max(diagonal[i], 1e-9);
    out.signal(static_cast<Eigen::Index>(i), signal) = after;
  }
}

ShaftRipple RippleOf(const Episode& episode, int signal, const std::vector<double>& turns) {
  std::vector<double> readings;
  for (int row = 0; row < episode.rows(); ++row) readings.push_back(episode.signal(row, signal));
  return {turns, readings};
}

/// Means over whole revolutions, at the row where each ends. Over the angle, not over time: that is what repeats with the shaft.
/// A ripple that grows or fades within a revolution has a mean of its own: it is taken out before.
void TakeMeans(const Episode& episode, int signal, const std::vector<double>& turns,
               const std::vector<Place>& places, Episode& out) {
  out.signal.col(signal).setConstant(std::numeric_limits<double>::quiet_NaN());
  const ShaftRipple ripple = RippleOf(episode, signal, turns);
  for (Eigen::Index k = 0; k < out.rows(); ++k)
    out.ripple(k, signal) = ripple.SlowAt(static_cast<double>(k) / out.mean_rows, out.mean_rows);
  const auto reading = [&](int row) { return episode.signal(row, signal) - ripple.At(turns[row]); };
  const auto step = static_cast<std::size_t>(out.mean_rows);
  for (std::size_t k = step; k < places.size(); k += step) {
    const Place &from = places[k - step], &to = places[k];
    double sum = 0;
    for (int row = from.row; row <= to.row; ++row) {
      const auto at = static_cast<std::size_t>(row);
      const double begin = row == from.row ? from.share : 0.0, end = row == to.row ? to.share : 1.0;
      const double y = reading(row), rise = reading(row + 1) - y;
      sum += (turns[at + 1] - turns[at]) * (end - begin) * (y + 0.5 * (begin + end) * rise);
    }
    out.signal(static_cast<Eigen::Index>(k), signal) = sum;
  }
}

}  // namespace

double RowsPerRevolution(const Episode& episode, int speed) {
  const double revolutions = AnglesOf(episode, speed).back();
  return revolutions > 0 ? episode.rows() / revolutions : 0.0;
}

Episode AtShaftAngles(const Episode& episode, int speed, const std::vector<int>& outputs, InputHold hold) {
  const std::vector<double> turns = AnglesOf(episode, speed);
  Episode out;
  out.mean_rows = (outputs.size() > 1 ? 2 : 1) * kRowsPerRevolution;
  const std::vector<Place> places = PlacesOf(episode, turns, out.mean_rows);
  out.log = episode.log;
  out.first_row = episode.first_row;
  if (places.size() < 2) return out;
  for (const Place& p : places) out.time.push_back(p.time);
  out.signal.resize(out.rows(), episode.signal.cols());
  out.ripple = RowMatrix::Zero(out.rows(), episode.signal.cols());
  for (int s = 0; s < episode.signal.cols(); ++s) {
    if (Contains(outputs, s))
      TakeMeans(episode, s, turns, places, out);
    else if (hold != InputHold::kZero)
      TakePolygon(episode, s, places, out);
    else
      TakeLevels(episode, s, places, out);
  }
  return out;
}

}  // namespace hydroscope
