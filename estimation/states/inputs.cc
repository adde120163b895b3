// Inputs of StateSimulator between rows, as they are and delayed.

#include <algorithm>
#include <array>

#include "core/limits.h"
#include "estimation/states/row_course.h"
#include "estimation/states/simulation.h"

namespace hydroscope {
namespace {

/// Of an input over a time in which no row arrives, and its rate. Before the episode it is what it is at its first row, after it
/// what at its last.
struct InputPart {
  RowCourse course, rate;
};
InputPart PartOf(const Episode& episode, int signal, InputHold hold, double begin, double end) {
  // The row that holds in the middle of the part holds over all of it.
  const auto later = std::ranges::upper_bound(episode.time, 0.5 * (begin + end));
  if (later == episode.time.begin()) return {{episode.signal(0, signal), episode.signal(0, signal)}, {}};
  const std::size_t k = static_cast<std::size_t>(later - episode.time.begin()) - 1;
  const RowCourse whole = CourseOf(episode, static_cast<int>(k), signal, hold);
  if (k + 1 == episode.time.size()) return {whole, {}};
  const double since = episode.time[k], apart = episode.time[k + 1] - since;
  const double from = (begin - since) / apart, to = (end - since) / apart;
  return {whole.Part(from, to), whole.Rate(apart).Part(from, to)};
}

}  // namespace

void StateSimulator::InputAt(double fraction) {
  if (hold_ == InputHold::kZero) {
    CopyFew(u0_.data(), inputs_, u_.data());
    return;
  }
  const double rest = 1 - fraction;
  for (std::size_t i = 0; i < u_.size(); ++i) u_[i] = rest * u0_[i] + fraction * u1_[i];
  if (hold_ != InputHold::kSmooth) return;
  const double before = rest * (rest * rest - 1), after = fraction * (fraction * fraction - 1);
  for (std::size_t i = 0; i < u_.size(); ++i) u_[i] += before * bend0_[i] + after * bend1_[i];
}

/// Whether the inputs begin a row as the step before left them: its last stage is then the first of the next step.
bool StateSimulator::BeginsAsItEnded() { return ended_u_ == u0_; }

/// Inputs at a row and at the next one; of the last row, and where outputs are read at other times, at it alone. What is delayed:
/// TakeDelayed.
void StateSimulator::TakeInputs(const Episode& episode, int row) {
  if (late_ != 0) {
    TakeParts(episode, row, 0, 0);
    return;
  }
  for (std::size_t i = 0; i < model_->inputs.size(); ++i)
    Take(CourseOf(episode, row, model_->inputs[i], hold_), i);
  if (!model_->delays.empty()) TakeDelayed(episode, row, 0, 0);
  TakeRipples(episode, row, 0, 1);
}

/// All inputs from one share of a row's time to another between which none of them jumps or bends (Breaks).
void StateSimulator::TakeParts(const Episode& episode, int row, double from, double to) {
  const auto at = static_cast<std::size_t>(row);
  const double begin = episode.time[at] - late_,
               period = at + 1 < episode.time.size() ? episode.time[at + 1] - episode.time[at] : 0;
  for (std::size_t i = 0; i < model_->inputs.size(); ++i)
    Take(late_ == 0
             ? CourseOf(episode, row, model_->inputs[i], hold_).Part(from, to)
             : PartOf(episode, model_->inputs[i], hold_, begin + from * period, begin + to * period).course,
         i);
  if (!model_->delays.empty()) TakeDelayed(episode, row, from, to);
  TakeRipples(episode, row, from, to);
}

/// Lines between the rows, whatever other inputs do; where inputs are held, their mean.
void StateSimulator::TakeRipples(const Episode& episode, int row, double from, double to) {
  std::size_t place = static_cast<std::size_t>(inputs_) - model_->ripples.size();
  for (const int signal : model_->ripples) {
    RowCourse course;
    if (episode.ripple.size() > 0) {
      course.begin = episode.ripple(row, signal);
      course.end = episode.ripple(std::min<Eigen::Index>(row + 1, episode.rows() - 1), signal);
    }
    course = course.Part(from, to);
    if (hold_ == InputHold::kZero) course.begin = course.end = 0.5 * (course.begin + course.end);
    Take(course, place++);
  }
}

void StateSimulator::Take(const RowCourse& course, std::size_t place) {
  u0_[place] = course.begin;
  u1_[place] = course.end;
  bend0_[place] = course.bend_begin;
  bend1_[place] = course.bend_end;
}

/// Shares of the time from a row to the next at which the rows of inputs that are not those of the row arrive, with 0 and 1.
void StateSimulator::Breaks(const Episode& episode, int row) {
  constexpr double kApart = 1e-9;
  const auto at = static_cast<std::size_t>(row);
  breaks_.assign({0.0, 1.0});
  const double begin = episode.time[at], period = episode.time[at + 1] - begin;
  const auto arrive = [&](double seconds) {
    for (auto t = std::ranges::upper_bound(episode.time, begin - seconds);
         t != episode.time.end() && *t + seconds < begin + period; ++t)
      breaks_.push_back((*t + seconds - begin) / period);
  };
  if (late_ != 0) arrive(late_);
  for (const DelayedInput& delay : model_->delays)
    arrive(late_ + (delay.parameter < 0 ? delay.seconds : theta_[delay.parameter]));
  std::ranges::sort(breaks_);
  breaks_.erase(
      std::unique(breaks_.begin(), breaks_.end(), [](double a, double b) { return b - a < kApart; }),
      breaks_.end());
  breaks_.back() = 1;
}

/// Delayed inputs from one share of a row's time to another between which none of them jumps or bends; before the episode
/// they are what they are at its first row. Where one jumps, a state arrives there with the rate of before for as much longer
/// as the delay grows: its sensitivity jumps by the difference of the rates.
void StateSimulator::TakeDelayed(const Episode& episode, int row, double from, double to) {
  const auto at = static_cast<std::size_t>(row);
  const double period = at + 1 < episode.time.size() ? episode.time[at + 1] - episode.time[at] : 0;
  const bool jumps = with_slopes_ && hold_ == InputHold::kZero && !(row == first_ && from == 0);
  std::array<double, kMaxStates> before, after;
  for (std::size_t d = 0; d < model_->delays.size(); ++d) {
    const DelayedInput& delay = model_->delays[d];
    const double seconds = delay.parameter < 0 ? delay.seconds : theta_[delay.parameter];
    const double begin = episode.time[at] - late_ - seconds;
    const auto [course, rate] =
        PartOf(episode, model_->inputs[delay.input], hold_, begin + from * period, begin + to * period);
    const std::size_t place = model_->inputs.size() + static_cast<std::size_t>(DelayedInput::kRegisters) * d;
    const bool jump =
        jumps && delay.parameter >= 0 && delay.parameter < parameters_ && course.begin != u0_[place];
    if (jump) Rate(x_.data(), 0, before.data());
    Take(course, place);
    Take(rate, place + 1);
    Take({seconds, seconds}, place + 2);
    if (!jump) continue;
    Rate(x_.data(), 0, after.data());
    for (int i = 0; i < states_; ++i) s_[i * columns_ + delay.parameter] += before[i] - after[i];
  }
}

/// From a row to the next, in parts where delayed inputs jump or bend in between.
bool StateSimulator::Row(const Episode& episode, int row) {
  const auto at = static_cast<std::size_t>(row);
  const double period = episode.time[at + 1] - episode.time[at];
  if (model_->delays.empty() && late_ == 0) return Interval(period);
  Breaks(episode, row);
  double before = 1;
  for (std::size_t b = 0; b + 1 < breaks_.size(); ++b) {
    const double from = breaks_[b], to = breaks_[b + 1];
    TakeParts(episode, row, from, to);
    next_share_ = std::min(1.0, next_share_ * before / (to - from));
    before = to - from;
    if (!Interval(period * (to - from))) return false;
  }
  next_share_ = std::min(1.0, next_share_ * before);
  return true;
}

}  // namespace hydroscope
