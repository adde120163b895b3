// Inputs of StateSimulator between rows: held or moving evenly, and delayed.

#include <algorithm>
#include <array>

#include "core/limits.h"
#include "estimation/states/simulation.h"

namespace hydroscope {

void StateSimulator::InputAt(double fraction) {
  for (std::size_t i = 0; i < u_.size(); ++i)
    u_[i] = linear_ ? (1 - fraction) * u0_[i] + fraction * u1_[i] : u0_[i];
}

/// Whether the inputs begin a row as the step before left them: its last stage is then the first of the next step.
bool StateSimulator::BeginsAsItEnded() { return ended_u_ == u0_; }

/// Inputs at a row and at the next one; of the last row at it alone. What is delayed: TakeDelayed.
void StateSimulator::TakeInputs(const Episode& episode, int row) {
  const int next = std::min(row + 1, episode.rows() - 1);
  for (std::size_t i = 0; i < model_->inputs.size(); ++i) {
    u0_[i] = episode.signal(row, model_->inputs[i]);
    u1_[i] = episode.signal(next, model_->inputs[i]);
  }
}

/// Shares of the time from a row to the next at which the rows of delayed inputs arrive, with 0 and 1.
void StateSimulator::Breaks(const Episode& episode, int row) {
  constexpr double kApart = 1e-9;
  const auto at = static_cast<std::size_t>(row);
  breaks_.assign({0.0, 1.0});
  const double begin = episode.time[at], period = episode.time[at + 1] - begin;
  for (const DelayedInput& delay : model_->delays) {
    const double seconds = delay.parameter < 0 ? delay.seconds : theta_[delay.parameter];
    for (auto t = std::upper_bound(episode.time.begin(), episode.time.end(), begin - seconds);
         t != episode.time.end() && *t + seconds < begin + period; ++t)
      breaks_.push_back((*t + seconds - begin) / period);
  }
  std::sort(breaks_.begin(), breaks_.end());
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
  const bool jumps = with_slopes_ && !linear_ && !(row == first_ && from == 0);
  std::array<double, kMaxStates> before, after;
  for (std::size_t d = 0; d < model_->delays.size(); ++d) {
    const DelayedInput& delay = model_->delays[d];
    const double seconds = delay.parameter < 0 ? delay.seconds : theta_[delay.parameter];
    const auto value = [&](double time, std::size_t k) {
      const double here =
          episode.signal(static_cast<Eigen::Index>(k), model_->inputs[static_cast<std::size_t>(delay.input)]);
      if (!linear_ || k + 1 >= episode.time.size()) return std::pair(here, 0.0);
      const double next = episode.signal(static_cast<Eigen::Index>(k + 1),
                                         model_->inputs[static_cast<std::size_t>(delay.input)]);
      const double rate = (next - here) / (episode.time[k + 1] - episode.time[k]);
      return std::pair(here + rate * (time - episode.time[k]), rate);
    };
    // The row that holds in the middle of the part holds over all of it.
    const double begin = episode.time[at] + from * period - seconds,
                 end = episode.time[at] + to * period - seconds;
    const auto later = std::upper_bound(episode.time.begin(), episode.time.end(), 0.5 * (begin + end));
    const bool early = later == episode.time.begin();
    const std::size_t k = early ? 0 : static_cast<std::size_t>(later - episode.time.begin()) - 1;
    const auto [first, rate] = early ? std::pair(value(episode.time[0], 0).first, 0.0) : value(begin, k);
    const double last = early ? first : value(end, k).first;
    const std::size_t place = model_->inputs.size() + static_cast<std::size_t>(DelayedInput::kRegisters) * d;
    const bool jump = jumps && delay.parameter >= 0 && first != u0_[place];
    if (jump) Rate(x_.data(), 0, before.data());
    u0_[place] = first;
    u1_[place] = last;
    u0_[place + 1] = u1_[place + 1] = rate;
    u0_[place + 2] = u1_[place + 2] = seconds;
    if (!jump) continue;
    Rate(x_.data(), 0, after.data());
    for (int i = 0; i < states_; ++i)
      s_[static_cast<std::size_t>(i * columns_ + delay.parameter)] +=
          before[static_cast<std::size_t>(i)] - after[static_cast<std::size_t>(i)];
  }
}

/// From a row to the next, in parts where delayed inputs jump or bend in between.
bool StateSimulator::Row(const Episode& episode, int row) {
  const auto at = static_cast<std::size_t>(row);
  const double period = episode.time[at + 1] - episode.time[at];
  if (model_->delays.empty()) return Interval(period);
  Breaks(episode, row);
  const std::size_t undelayed = model_->inputs.size();
  double before = 1;
  for (std::size_t b = 0; b + 1 < breaks_.size(); ++b) {
    const double from = breaks_[b], to = breaks_[b + 1];
    TakeInputs(episode, row);
    for (std::size_t i = 0; linear_ && i < undelayed; ++i) {
      const double begin = u0_[i], rise = u1_[i] - begin;
      u0_[i] = begin + from * rise;
      u1_[i] = begin + to * rise;
    }
    TakeDelayed(episode, row, from, to);
    next_share_ = std::min(1.0, next_share_ * before / (to - from));
    before = to - from;
    if (!Interval(period * (to - from))) return false;
  }
  next_share_ = std::min(1.0, next_share_ * before);
  return true;
}

}  // namespace hydroscope
