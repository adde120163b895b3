#include "acquisition/straight_runs.h"

#include <algorithm>
#include <cmath>

#include "acquisition/held_back.h"

namespace hydroscope {
namespace {

/// Rounding moves each of three readings by half a step at most, that in the middle twice: 2, and a little for the doubles.
constexpr double kRoundedBend = 2.05;
/// Of bends of white noise, in their standard deviations: the tenth that is smallest, and the density at 0.
constexpr double kLeastBent = 0.1, kLeastOfNormal = 0.1257, kDensityAtZero = 0.3989;
/// Neighbouring bends of white noise have opposite signs at three readings of four (correlation -2/3), those of motion and of
/// corners between straight lines seldom.
constexpr std::int64_t kBentToTell = 100;
constexpr double kOpposedBends = 0.3;
constexpr double kRareStraightRun = 1e-8;
constexpr std::size_t kShortestRun = 2, kLongestRunNeeded = 6;

}  // namespace

StraightRuns::StraightRuns(std::size_t signals) : channels_(signals) {}

void StraightRuns::Inspect(SampleBlock& block) {
  if (block.rows() == 0) return;
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    Learn(block.signal[c], channels_[c]);
    Judge(channels_[c]);
  }
  AppendRows(block, held_);
  std::swap(block, held_);
  std::size_t open = 1;
  for (std::size_t c = 0; c < channels_.size(); ++c)
    open = std::max(open, Flag(block.signal[c], channels_[c], block.quality[c]));
  held_ = TakeLastRows(block, std::min(open, block.rows()));
  if (block.rows() == 0) return;
  for (std::size_t c = 0; c < channels_.size(); ++c) channels_[c].last = block.signal[c].back();
}

void StraightRuns::Flush(SampleBlock& block) {
  block = std::move(held_);
  held_ = {};
}

void StraightRuns::Learn(const std::vector<double>& coming, Channel& channel) {
  double before = 0;    // bend of the reading before, 0 where it is none
  std::size_t run = 0;  // readings without one up to there
  for (std::size_t k = 1; k + 1 < coming.size(); ++k) {
    const double step = std::abs(coming[k] - coming[k - 1]);
    if (step > 0) channel.least_step = channel.least_step > 0 ? std::min(channel.least_step, step) : step;
    const double bend = (coming[k + 1] - coming[k]) - (coming[k] - coming[k - 1]);
    const double size = std::abs(bend);
    ++channel.readings;
    if (size > channel.straight) {
      ++channel.bends[kBins.Of(size)];
      ++channel.bent;
      channel.turned += bend * before < 0;
      channel.alone += run == 1;
      before = bend;
      run = 0;
    } else {
      before = 0;
      ++run;
    }
  }
}

/// How many readings without a bend the noise makes too rarely.
void StraightRuns::Judge(Channel& channel) {
  channel.straight = kRoundedBend * channel.least_step;
  channel.fewest = 0;
  if (channel.bent < kBentToTell ||
      static_cast<double>(channel.turned) < kOpposedBends * static_cast<double>(channel.bent))
    return;
  // Readings that are drawn do not bend, and motion bends more than noise does: the noise is that of those that bend least.
  std::int64_t below = 0;
  std::size_t bin = 0;
  while (static_cast<double>(below) < kLeastBent * static_cast<double>(channel.bent))
    below += channel.bends[bin++];
  const double std = kBins.SizeAt(static_cast<double>(bin) - 0.5) / kLeastOfNormal;
  const double seen = static_cast<double>(channel.alone) / static_cast<double>(channel.readings);
  const double chance = std::max(seen, 2 * channel.straight * kDensityAtZero / std);
  if (!(chance < 1)) return;
  const auto needed = static_cast<std::size_t>(std::ceil(std::log(kRareStraightRun) / std::log(chance)));
  if (needed <= kLongestRunNeeded) channel.fewest = std::max(kShortestRun, needed);
}

std::size_t StraightRuns::Flag(const std::vector<double>& values, Channel& channel,
                               std::vector<Quality>& flags) {
  if (channel.fewest == 0) {
    channel.drawn = 0;
    return 1;
  }
  std::size_t run = channel.drawn;  // readings without a bend up to the one before row k
  double before = channel.last;
  for (std::size_t k = 1; k < values.size(); ++k) {
    const double at = values[k - 1], step = values[k] - at, bend = step - (at - before);
    run = std::abs(bend) <= channel.straight && step != 0 ? run + 1 : 0;
    // Of a run that began in rows given out the first ones are flagged already.
    const std::size_t flagged = run == channel.fewest ? std::min(run, k) : run > channel.fewest ? 1 : 0;
    for (std::size_t back = 1; back <= flagged; ++back) flags[k - back] |= quality::kInterpolated;
    before = at;
  }
  const bool open = run < channel.fewest;
  channel.drawn = open ? 0 : run;
  return open ? run + 1 : 1;
}

}  // namespace hydroscope
