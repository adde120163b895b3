#include "acquisition/quality_monitor.h"

#include <algorithm>
#include <cmath>

namespace hydroscope {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Median of |third difference| of white noise of standard deviation 1: 0.6745 sqrt(1 + 9 + 9 + 1).
constexpr double kMedianThirdDifference = 3.0165;
// Standard deviation of the distance to the mean of both neighbours: sqrt(1 + 1/4 + 1/4), here of twice it.
constexpr double kTwiceDistanceStd = 2.4495;
constexpr double kSpikeStd = 12.0;
constexpr double kSpikeOverNeighbours = 3.0;

constexpr std::int64_t kChangesToJudge = 100;
constexpr double kReversalsOfNoise = 0.3;
constexpr double kRunsToBeStuck = 25.0;

constexpr Quality kBreaks =
    quality::kMissing | quality::kGap | quality::kTimeBackwards | quality::kClockJump | quality::kDuplicate;

}  // namespace

/// What one pass over a piece of a column counts.
struct QualityMonitor::Counts {
  std::int64_t different = 0;   ///< third differences other than zero
  std::int64_t above = 0;       ///< third differences above the scale
  std::int64_t candidates = 0;  ///< values far off the mean of their neighbours
  std::int64_t equal = 0;       ///< readings equal to the one before
  std::int64_t changes = 0;     ///< readings different from the one before
  std::int64_t reversals = 0;   ///< changes of direction
  std::int64_t outside = 0;     ///< readings outside the limits
};

QualityMonitor::QualityMonitor(const Machine& machine, double sample_period) : sample_period_(sample_period) {
  for (const SignalSpec& spec : machine.signals) {
    Track track;
    track.low = spec.min.value_or(-kInfinity);
    track.high = spec.max.value_or(kInfinity);
    track.known_noise = spec.noise_std.value_or(0.0);
    if (spec.stuck_time > 0)
      track.stuck_rows =
          std::max<std::int64_t>(2, std::llround(std::ceil(spec.stuck_time / sample_period - 1e-9)) + 1);
    track.before.fill(kNaN);
    tracks_.push_back(track);
    ChannelQuality channel;
    channel.name = spec.name;
    channels_.push_back(channel);
  }
}

void QualityMonitor::Inspect(SampleBlock& block) {
  const std::size_t rows = block.rows();
  if (rows == 0) return;
  const double last_time = block.time[rows - 1];
  InspectRows(block, rows - (holding_ ? 0 : 1), true);
  held_time_ = last_time;
  holding_ = true;
}

void QualityMonitor::Flush(SampleBlock& block) {
  block.Resize(tracks_.size(), 0);
  if (!holding_) return;
  InspectRows(block, 1, false);
  holding_ = false;
}

/// Gives out `rows` rows. The row after them is the last one of `block` or, at the end of the log, unknown.
void QualityMonitor::InspectRows(SampleBlock& block, std::size_t rows, bool last_row_known) {
  if (last_row_known && holding_) {
    std::copy_backward(block.time.begin(), block.time.end() - 1, block.time.end());
    block.time[0] = held_time_;
  }
  if (!last_row_known) block.Resize(tracks_.size(), rows);
  if (!last_row_known) block.time[0] = held_time_;
  const std::int64_t frame_row = frame_row_;
  for (std::size_t channel = 0; channel < tracks_.size(); ++channel) {
    TakeColumn(block, channel, last_row_known ? block.signal[channel].size() : 0);
    Track& track = tracks_[channel];
    frame_row_ = frame_row;
    for (std::size_t row = 0; row < rows;) {
      const std::size_t piece = std::min(rows - row, static_cast<std::size_t>(kFrame - frame_row_));
      const double* x = column_.data() + kHistory + row;
      Quality* flags = flags_.data() + row;
      const Counts counts = Count(x, piece, track);
      if (counts.outside > 0) FlagRange(x, piece, track, flags);
      if (counts.candidates > 0) FlagSpikes(x, piece, track, flags);
      if (counts.equal > 0) {
        FlagStuck(x, piece, track, flags);
      } else {
        track.run = 1;
      }
      if (track.first_count < kFrame) CollectFirst(x, piece, track);
      track.readings += counts.equal + counts.changes;
      track.changes += counts.changes;
      track.reversals += counts.reversals;
      track.different += counts.different;
      track.above += counts.above;
      row += piece;
      frame_row_ += static_cast<std::int64_t>(piece);
      if (frame_row_ == kFrame) {
        frame_row_ = 0;
        BeginFrame(track);
      }
    }
    std::copy_n(column_.begin() + kHistory, rows, block.signal[channel].begin());
    std::copy_n(flags_.begin(), rows, block.quality[channel].begin());
    std::copy_n(column_.begin() + static_cast<std::ptrdiff_t>(rows), kHistory, track.before.begin());
    track.held = column_[kHistory + rows];
    track.held_quality = flags_[rows];
    channels_[channel].noise_std = track.scale > 0 ? track.scale / kMedianThirdDifference : kNaN;
  }
  block.Resize(tracks_.size(), rows);
  CountFlags(block, rows);
}

/// Lines up history, row held back and new rows of a channel; a row after the last one that is not known is
/// NaN.
void QualityMonitor::TakeColumn(SampleBlock& block, std::size_t channel, std::size_t rows) {
  const Track& track = tracks_[channel];
  const std::size_t held = holding_ ? 1 : 0;
  if (column_.size() < kHistory + held + rows + 1) {
    column_.resize(kHistory + held + rows + 1);
    flags_.resize(held + rows + 1);
  }
  auto value = std::copy(track.before.begin(), track.before.end(), column_.begin());
  auto flag = flags_.begin();
  if (holding_) {
    *value++ = track.held;
    *flag++ = track.held_quality;
  }
  if (rows == 0) {
    *value = kNaN;
    *flag = quality::kGood;
  } else {
    std::copy_n(block.signal[channel].begin(), rows, value);
    std::copy_n(block.quality[channel].begin(), rows, flag);
  }
}

/// NaN makes every comparison false, so missing values count nowhere.
QualityMonitor::Counts QualityMonitor::Count(const double* x, std::size_t rows, const Track& track) const {
  const double scale = track.scale;
  const double sigma = std::max(scale / kMedianThirdDifference, track.known_noise);
  const double far = track.settled ? kSpikeStd * kTwiceDistanceStd * sigma : kInfinity;
  const double low = track.low;
  const double high = track.high;
  Counts counts;
  for (std::size_t i = 0; i < rows; ++i) {
    const double* v = x + i;
    const double step = v[0] - v[-1];
    const double step_before = v[-1] - v[-2];
    const double step_after = v[1] - v[0];
    const double third = std::abs((v[1] - v[-2]) - 3.0 * step);
    counts.different += third > 0.0;
    counts.above += third > scale;
    counts.candidates += std::abs(step_after - step) > far;
    counts.equal += step == 0.0;
    counts.changes += std::abs(step) > 0.0;
    counts.reversals += step * step_before < 0.0;
    counts.outside += (v[0] < low) | (v[0] > high);
  }
  return counts;
}

/// The scale starts as the median of the first 64 third differences other than zero.
void QualityMonitor::CollectFirst(const double* x, std::size_t rows, Track& track) {
  for (std::size_t i = 0; i < rows && track.first_count < kFrame; ++i) {
    const double* v = x + i;
    const double third = std::abs((v[1] - v[-2]) - 3.0 * (v[0] - v[-1]));
    if (third > 0.0) track.first[static_cast<std::size_t>(track.first_count++)] = third;
  }
}

void QualityMonitor::FlagRange(const double* x, std::size_t rows, const Track& track, Quality* flags) {
  for (std::size_t i = 0; i < rows; ++i)
    if (x[i] < track.low || x[i] > track.high) flags[i] |= quality::kOutOfRange;
}

void QualityMonitor::FlagStuck(const double* x, std::size_t rows, Track& track, Quality* flags) {
  for (std::size_t i = 0; i < rows; ++i) {
    track.run = x[i] == x[i - 1] ? track.run + 1 : 1;
    if (track.stuck_limit == 0 || track.run <= track.stuck_limit) continue;
    flags[i] |= quality::kStuck;
    --track.readings;  // a stuck reading says nothing about how long readings normally stay
  }
}

void QualityMonitor::FlagSpikes(const double* x, std::size_t rows, const Track& track, Quality* flags) {
  const double sigma = std::max(track.scale / kMedianThirdDifference, track.known_noise);
  for (std::size_t i = 0; i < rows; ++i) {
    const double* v = x + i;
    const double distance = 0.5 * std::abs((v[1] - v[0]) - (v[0] - v[-1]));
    if (!(2.0 * distance > kSpikeStd * kTwiceDistanceStd * sigma)) continue;
    const bool neighbours_agree = kSpikeOverNeighbours * std::abs(v[1] - v[-1]) <= distance;
    const bool quiet_before = kSpikeOverNeighbours * std::abs(v[-1] - v[-2]) <= distance;
    if (neighbours_agree && quiet_before && ((flags[i] | flags[i + 1]) & kBreaks) == 0)
      flags[i] |= quality::kSpike;
  }
}

/// Follows the median: half of the third differences should lie above it. Steps are bounded, so a transient
/// moves it little; a frame almost entirely above it means that the scale is far too small.
void QualityMonitor::BeginFrame(Track& track) {
  const bool noisy =
      track.changes >= kChangesToJudge &&
      static_cast<double>(track.reversals) >= kReversalsOfNoise * static_cast<double>(track.changes);
  track.stuck_limit = 0;
  if (noisy && track.stuck_rows > 0) {
    const double mean_run = static_cast<double>(track.readings) / static_cast<double>(track.changes);
    track.stuck_limit = std::max(track.stuck_rows, static_cast<std::int64_t>(kRunsToBeStuck * mean_run));
  }
  if (track.first_count < kFrame) return;
  if (track.scale == 0) {
    auto first = track.first;
    std::nth_element(first.begin(), first.begin() + kFrame / 2, first.end());
    track.scale = first[kFrame / 2];
    track.settled = true;
  } else if (track.different >= kFrame / 2) {
    const double share = static_cast<double>(track.above) / static_cast<double>(track.different);
    track.settled = share < 0.9;
    if (share >= 0.9) {
      track.scale *= 8;
    } else if (share > 0.1) {
      track.scale *= std::exp2(0.5 * (share - 0.5));
    } else {
      track.scale *= 0.9;
    }
  }
  track.different = track.above = 0;
}

void QualityMonitor::CountFlags(const SampleBlock& block, std::size_t rows) {
  for (std::size_t channel = 0; channel < channels_.size(); ++channel) {
    ChannelQuality& counted = channels_[channel];
    counted.rows += static_cast<std::int64_t>(rows);
    const Quality* flags = block.quality[channel].data();
    unsigned any = 0;
    for (std::size_t row = 0; row < rows; ++row) any |= flags[row];
    if (any == 0) continue;
    for (std::size_t row = 0; row < rows; ++row) {
      if (flags[row] == quality::kGood) continue;
      if (std::isnan(counted.first_bad)) counted.first_bad = block.time[row];
      counted.last_bad = block.time[row];
      for (std::size_t bit = 0; bit < counted.flagged.size(); ++bit)
        counted.flagged[bit] += (flags[row] >> bit) & 1;
    }
  }
}

}  // namespace hydroscope
