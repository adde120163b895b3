#include "acquisition/quality_monitor.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include "core/constants.h"
#include "core/parallel/wide.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kChangesToJudge = 100;
constexpr double kReversalsOfNoise = 0.3;
/// Share of third differences of the other sign than the one before: 0.77 of white noise (1/2 + asin(3/4)/pi), none of smooth motion.
constexpr double kThirdReversalsOfNoise = 0.6;
/// Median third difference over the least step of the channel: 1 of what rounding alone makes, 6 of noise of two steps.
constexpr double kOverLeastStep = 6.0;
constexpr double kLongestMeanRun = 1.5;
constexpr double kRunsToBeStuck = 25.0;
// Readings that a logger held: at the resting level runs are likelier than on average, so where they are not rare at all
// nothing is said.
constexpr double kRareRun = 1e-7;
constexpr double kLargestShareOfRuns = 0.02;
constexpr std::int64_t kShortestHold = 4;
// Commands rest for longer between their steps.
constexpr double kLongestMeanRunOfReadings = 10.0;

// Noise about a limit: half of its readings are cut off if the level lies at the limit. Of a whole channel, only a few
// of all readings are the very highest, however coarse its resolution.
constexpr std::int64_t kReadingsAtLimit = 30;
constexpr double kShareAtLimit = 0.25;
constexpr double kNearExtreme = 2.0;  // standard deviations of the noise

// Four rows at once: vectors of GCC and Clang.
typedef double Doubles __attribute__((vector_size(32)));
typedef std::int64_t Integers __attribute__((vector_size(32)));
constexpr std::size_t kLanes = 4;

/// What one pass over a piece of a column counts.
struct Counts {
  std::int64_t different = 0;                       ///< third differences other than zero
  std::int64_t above = 0;                           ///< third differences above the scale
  std::int64_t candidates = 0;                      ///< values far off the mean of their neighbours
  std::int64_t equal = 0;                           ///< readings equal to the one before
  std::int64_t changes = 0;                         ///< readings different from the one before
  std::int64_t reversals = 0;                       ///< changes of direction
  std::int64_t third_reversals = 0;                 ///< third differences of the other sign than the next
  double least_square = kInfinity;                  ///< of the steps other than zero
  std::int64_t outside = 0;                         ///< readings beyond the limits
  std::int64_t near_high = 0, near_low = 0;         ///< readings beyond Thresholds::near_high, near_low
  double highest = -kInfinity, lowest = kInfinity;  ///< readings
};

struct Thresholds {
  double scale = 0;          ///< of third differences
  double far = 0;            ///< of twice the distance to the mean of both neighbours
  double low = 0, high = 0;  ///< of readings
  double near_low = -kInfinity, near_high = kInfinity;  ///< of readings near the ends of the range seen
};

/// What lies beyond `rows` is NaN.
inline void Load(const double* x, std::size_t rows, Doubles& four) {
  four = Doubles{kNaN, kNaN, kNaN, kNaN};
  std::memcpy(&four, x, rows * sizeof(double));
}

inline std::int64_t Sum(const Integers& four) { return (four[0] + four[1]) + (four[2] + four[3]); }

/// Looks from two rows before to two rows after each of `rows` rows. NaN makes every comparison false, so
/// missing values count nowhere.
HYDROSCOPE_WIDE Counts Count(const double* x, std::size_t rows, const Thresholds& thresholds) {
  const Doubles square_of_scale = Doubles{} + thresholds.scale * thresholds.scale;
  const Doubles square_of_far = Doubles{} + thresholds.far * thresholds.far;
  const Doubles low = Doubles{} + thresholds.low, high = Doubles{} + thresholds.high, zero{};
  Integers different{}, above{}, candidates{}, equal{}, changes{}, reversals{}, outside{};
  const Doubles from_high = zero + thresholds.near_high, from_low = zero + thresholds.near_low;
  Doubles highest = zero - kInfinity, lowest = zero + kInfinity;
  Integers near_high{}, near_low{}, third_reversals{};
  Doubles least_square = zero + kInfinity;
  const auto add = [&](const double* from, std::size_t count) {
    Doubles second_before, before, at, after, second_after;
    Load(from - 2, count, second_before);
    Load(from - 1, count, before);
    Load(from, count, at);
    Load(from + 1, count, after);
    Load(from + 2, count, second_after);
    const Doubles step = at - before;
    const Doubles square_of_step = step * step;
    const Doubles third = (after - second_before) - 3.0 * step;
    const Doubles next_third = (second_after - before) - 3.0 * (after - at);
    const Doubles bend = (after - at) - step;
    // A comparison gives -1 where it is true. Squares spare the absolute values.
    different -= third * third > zero;
    above -= third * third > square_of_scale;
    candidates -= bend * bend > square_of_far;
    equal -= step == zero;
    changes -= square_of_step > zero;
    third_reversals -= third * next_third < 0;
    least_square =
        ((square_of_step > zero) & (square_of_step < least_square)) ? square_of_step : least_square;
    reversals -= step * (before - second_before) < zero;
    outside -= (at < low) | (at > high);
    highest = at > highest ? at : highest;
    lowest = at < lowest ? at : lowest;
    near_high -= at > from_high;
    near_low -= at < from_low;
  };
  std::size_t i = 0;
  for (; i + kLanes <= rows; i += kLanes) add(x + i, kLanes);
  if (i < rows) add(x + i, rows - i);
  return {Sum(different),
          Sum(above),
          Sum(candidates),
          Sum(equal),
          Sum(changes),
          Sum(reversals),
          Sum(third_reversals),
          std::min(std::min(least_square[0], least_square[1]), std::min(least_square[2], least_square[3])),
          Sum(outside),
          Sum(near_high),
          Sum(near_low),
          std::max(std::max(highest[0], highest[1]), std::max(highest[2], highest[3])),
          std::min(std::min(lowest[0], lowest[1]), std::min(lowest[2], lowest[3]))};
}

/// A command may stay at its limit for long.
bool IsCommand(const Machine& machine, const std::string& signal) {
  if (signal == machine.valve.input) return true;
  for (const StandstillRule& rule : KindOf(machine).standstill)
    if (rule.command == signal) return true;
  return false;
}

}  // namespace

QualityMonitor::QualityMonitor(const Machine& machine, double sample_period)
    : guard_(ExpressionGuard::For(machine)) {
  for (const SignalSpec& spec : machine.signals) {
    Track track;
    track.low = spec.min.value_or(-kInfinity);
    track.high = spec.max.value_or(kInfinity);
    track.known_noise = spec.noise_std.value_or(0.0);
    if (spec.stuck_time > 0)
      track.stuck_rows =
          std::max<std::int64_t>(2, std::llround(std::ceil(spec.stuck_time / sample_period - 1e-9)) + 1);
    track.before.fill(kNaN);
    track.extremes.fill({-kInfinity, 0, 0, false});
    track.is_marker = spec.name == machine.episode_marker;
    if (track.is_marker) track.stuck_rows = 0;
    track.can_saturate = !track.is_marker && !IsCommand(machine, spec.name);
    if (track.stuck_rows > 0)
      hold_ = std::max({hold_, static_cast<std::size_t>(track.stuck_rows) + kAhead,
                        static_cast<std::size_t>(kRunsToBeStuck * kLongestMeanRun) + 1 + kAhead});
    tracks_.push_back(track);
    ChannelQuality channel;
    channel.name = spec.name;
    channels_.push_back(channel);
  }
  hold_ = std::min(hold_, kMostHeld);
  longest_gap_ = hold_ - kAhead;
  standstill_ = Standstill::For(machine, sample_period);
  standing_ = StandingOutput::For(machine, sample_period);
  for (std::size_t c = 0; c < tracks_.size(); ++c) {
    tracks_[c].held_run = tracks_[c].stuck_rows > 0 ? longest_gap_ : 0;
    if (standstill_) tracks_[c].held_run = std::max(tracks_[c].held_run, standstill_->Reach(c));
  }
  if (standing_) {
    Track& track = tracks_[standing_->signal()];
    track.held_run = std::max(track.held_run, standing_->reach());
  }
  for (const Track& track : tracks_) hold_ = std::max(hold_, track.held_run + kAhead);
  for (Track& track : tracks_) {
    track.held.resize(hold_);
    track.held_quality.resize(hold_);
  }
  held_time_.resize(hold_);
}

void QualityMonitor::Inspect(SampleBlock& block) {
  const std::size_t coming = block.rows();
  if (coming == 0) return;
  if (standstill_) JudgeStandstill(block);
  if (standing_) {
    standing_->Judge(block);
    FlagHeld(standing_->signal(), standing_->before());
  }
  const std::size_t pulse = PulseUnderWay(block), run = RunUnderWay(block);
  const std::size_t total = held_ + coming, kept = std::min({total, hold_, kAhead + std::max(pulse, run)});
  const std::size_t rows = total - kept;
  const std::size_t judged = held_ - std::min(held_, kAhead), last = total - std::min(total, kAhead);
  const std::size_t first_frame_row = frame_row_;
  for (std::size_t channel = 0; channel < tracks_.size(); ++channel) {
    LineUp(block, channel);
    frame_row_ = first_frame_row;
    Judge(judged, last, tracks_[channel]);
    GiveOut(rows, kept, channel, block);
  }
  DelayTimes(rows, kept, block.time);
  block.Resize(tracks_.size(), rows);
  if (guard_) guard_->Flag(block, rows);
  CountFlags(block, rows);
}

/// What stands still in `block`, and in the rows held back before it.
void QualityMonitor::JudgeStandstill(SampleBlock& block) {
  standstill_->Judge(block);
  for (const auto& [signal, rows] : standstill_->before()) FlagHeld(signal, rows);
}

/// The newest of the rows held back stand.
void QualityMonitor::FlagHeld(std::size_t signal, std::size_t rows) {
  for (std::size_t k = 1; k <= std::min(rows, held_); ++k)
    tracks_[signal].held_quality[held_ - k] |= quality::kStuck;
}

/// Rows at the end of `block` and before that may yet turn out to be stuck: those of the longest run of one reading up
/// to a row that is not judged yet, and what came after it.
std::size_t QualityMonitor::RunUnderWay(const SampleBlock& block) {
  std::size_t longest = 0;
  for (std::size_t channel = 0; channel < tracks_.size(); ++channel) {
    Track& track = tracks_[channel];
    const std::vector<double>& x = block.signal[channel];
    const std::size_t first = x.size() - std::min(x.size(), track.runs.size());
    std::size_t begin = first;
    while (begin > 0 && x[begin - 1] == x[first]) --begin;
    std::size_t run = first - begin + 1 + (begin == 0 && x[0] == track.last ? track.runs.back() : 0);
    for (std::size_t k = first; k < x.size(); ++k) {
      if (k > first) run = x[k] == x[k - 1] ? run + 1 : 1;
      std::rotate(track.runs.begin(), track.runs.begin() + 1, track.runs.end());
      track.runs.back() = run;
    }
    track.last = x.back();
    for (std::size_t k = 0; k < track.runs.size(); ++k)
      if (track.runs[k] > 1)
        longest = std::max(longest, std::min(track.runs[k] + track.runs.size() - 1 - k, track.held_run));
  }
  return longest;
}

void QualityMonitor::Flush(SampleBlock& block) {
  const std::size_t rows = held_;
  block.Resize(tracks_.size(), rows);
  const std::size_t first_frame_row = frame_row_;
  for (std::size_t channel = 0; channel < tracks_.size(); ++channel) {
    Track& track = tracks_[channel];
    Reserve(kAhead);
    std::copy(track.before.begin(), track.before.end(), column_.begin());
    std::fill_n(column_.begin() + kHistory, rows + kAhead, kNaN);  // what would follow is not known
    for (std::size_t k = 0; k < rows; ++k) column_[kHistory + k] = track.held[k];
    std::fill_n(flags_.begin(), rows + kAhead, quality::kMissing);
    for (std::size_t k = 0; k < rows; ++k) flags_[k] = track.held_quality[k];
    frame_row_ = first_frame_row;
    Judge(rows - std::min(rows, kAhead), rows, track);
    GiveOut(rows, 0, channel, block);
  }
  for (std::size_t k = 0; k < rows; ++k) block.time[k] = held_time_[k];
  held_ = 0;
  if (guard_) guard_->Flag(block, rows);
  CountFlags(block, rows);
}

void QualityMonitor::Reserve(std::size_t rows) {
  const std::size_t size = kHistory + hold_ + kAhead + rows;
  if (column_.size() >= size) return;
  column_.resize(size);
  flags_.resize(size);
}

/// Puts history, rows held back and new rows of a channel one after the other.
void QualityMonitor::LineUp(const SampleBlock& block, std::size_t channel) {
  const Track& track = tracks_[channel];
  const auto held = static_cast<std::ptrdiff_t>(held_);
  Reserve(block.rows());
  auto value = std::copy(track.before.begin(), track.before.end(), column_.begin());
  value = std::copy(track.held.begin(), track.held.begin() + held, value);
  std::copy(block.signal[channel].begin(), block.signal[channel].end(), value);
  const auto flag = std::copy(track.held_quality.begin(), track.held_quality.begin() + held, flags_.begin());
  std::copy(block.quality[channel].begin(), block.quality[channel].end(), flag);
}

/// Judges rows `begin` to `end` of those lined up, in pieces that do not cross the frames of the noise scale.
void QualityMonitor::Judge(std::size_t begin, std::size_t end, Track& track) {
  for (std::size_t row = begin; row < end;) {
    const std::size_t piece = std::min(end - row, kFrame - frame_row_);
    const double* x = column_.data() + kHistory + row;
    Quality* flags = flags_.data() + row;
    const double far = track.settled && !track.is_marker ? LeastSpike(track) : kInfinity;
    const double near = kNearExtreme * Sigma(track);
    const Counts counts = Count(x, piece,
                                {track.scale, far, track.low, track.high, -track.extremes[1].value + near,
                                 track.extremes[0].value - near});
    track.readings += counts.equal + counts.changes;
    track.changes += counts.changes;
    track.reversals += counts.reversals;
    track.thirds += counts.different;
    track.third_reversals += counts.third_reversals;
    track.least_step = std::min(track.least_step, std::sqrt(counts.least_square));
    track.different += counts.different;
    track.above += counts.above;
    if (counts.outside > 0) FlagRange(x, piece, track, flags);
    if (counts.candidates > 0) {
      FlagSpikes(x, piece, track, flags);
      if (track.changes_often) FlagPulses(x, piece, track, flags);
    }
    if (counts.equal > 0 || track.run > 1) {
      FlagStuck(x, piece, track, flags);
    } else {
      track.run = 1;
    }
    if (track.can_saturate && track.stuck_limit > 0) {
      const std::array<std::pair<double, std::int64_t>, 2> ends = {
          {{counts.highest, counts.near_high}, {-counts.lowest, counts.near_low}}};
      for (std::size_t side = 0; side < ends.size(); ++side)
        if (ends[side].first >= track.extremes[side].value)
          WatchExtreme(side, x, piece, track, flags);
        else
          track.extremes[side].near += ends[side].second;
    }
    if (track.first_count < kFrame) CollectFirst(x, piece, track);
    row += piece;
    frame_row_ += piece;
    if (frame_row_ == kFrame) {
      frame_row_ = 0;
      BeginFrame(track);
    }
  }
}

/// Writes the rows judged back into the block and keeps what the next rows need.
void QualityMonitor::GiveOut(std::size_t rows, std::size_t kept, std::size_t channel, SampleBlock& block) {
  Track& track = tracks_[channel];
  const auto given = static_cast<std::ptrdiff_t>(rows);
  block.signal[channel].resize(rows);
  block.quality[channel].resize(rows);
  std::copy_n(column_.begin() + kHistory, rows, block.signal[channel].begin());
  std::copy_n(flags_.begin(), rows, block.quality[channel].begin());
  std::copy_n(column_.begin() + given, kHistory, track.before.begin());
  std::copy_n(column_.begin() + kHistory + given, kept, track.held.begin());
  std::copy_n(flags_.begin() + given, kept, track.held_quality.begin());
  channels_[channel].cut_off = {track.extremes[0].cut ? track.extremes[0].value : kNaN,
                                track.extremes[1].cut ? -track.extremes[1].value : kNaN};
  channels_[channel].noise_std = track.scale > 0 ? track.scale / kMedianThirdDifference : kNaN;
}

void QualityMonitor::DelayTimes(std::size_t rows, std::size_t kept, std::vector<double>& time) {
  times_.assign(held_time_.begin(), held_time_.begin() + static_cast<std::ptrdiff_t>(held_));
  times_.insert(times_.end(), time.begin(), time.end());
  time.assign(times_.begin(), times_.begin() + static_cast<std::ptrdiff_t>(rows));
  std::copy_n(times_.begin() + static_cast<std::ptrdiff_t>(rows), kept, held_time_.begin());
  held_ = kept;
}

/// The scale starts as the median of the first 64 third differences other than zero.
void QualityMonitor::CollectFirst(const double* x, std::size_t rows, Track& track) {
  for (std::size_t i = 0; i < rows && track.first_count < kFrame; ++i) {
    const double* v = x + i;
    const double third = std::abs((v[1] - v[-2]) - 3.0 * (v[0] - v[-1]));
    if (third > 0.0) track.first[track.first_count++] = third;
  }
}

void QualityMonitor::FlagRange(const double* x, std::size_t rows, const Track& track, Quality* flags) {
  for (std::size_t i = 0; i < rows; ++i)
    if (x[i] < track.low || x[i] > track.high) flags[i] |= quality::kOutOfRange;
}

void QualityMonitor::FlagStuck(const double* x, std::size_t rows, Track& track, Quality* flags) {
  for (std::size_t i = 0; i < rows; ++i) {
    const double* v = x + i;
    if (v[0] != v[-1] && track.run > 1 && IsFilledGap(v, track.run, track))
      FlagBack(flags + i, track.run, quality::kStuck);
    track.run = v[0] == v[-1] ? track.run + 1 : 1;
    track.repeated_runs += track.run == 2;
    if (track.held_limit == 0 || track.run <= track.held_limit) continue;
    if (track.run == track.held_limit + 1) FlagBack(flags + i, track.run - 1, quality::kStuck);
    flags[i] |= quality::kStuck;
    --track.readings;  // a stuck reading says nothing about how long readings normally stay
  }
}

/// Whether the `run` identical readings before `after` stand between two steps that no motion makes.
bool QualityMonitor::IsFilledGap(const double* after, std::int64_t run, const Track& track) const {
  if (!track.changes_often || track.stuck_rows == 0 || !track.settled ||
      run > static_cast<std::int64_t>(longest_gap_))
    return false;
  const double* first = after - run;
  const double in = first[0] - first[-1], out = after[0] - after[-1];
  const double step = std::min(std::abs(in), std::abs(out));
  const auto is_quiet = [step](double beside) { return kSpikeOverNeighbours * std::abs(beside) <= step; };
  return in * out < 0 && step > LeastStep(track) && is_quiet(after[0] - first[-1]) &&
         is_quiet(first[-1] - first[-2]) && is_quiet(after[1] - after[0]);
}

/// Flags the `rows` rows before `at` as far as they are held back.
void QualityMonitor::FlagBack(Quality* at, std::int64_t rows, Quality flag) {
  const auto reach = std::min<std::int64_t>(rows, at - flags_.data());
  for (std::int64_t k = 1; k <= reach; ++k) at[-k] |= flag;
}

/// Counts readings exactly at one end of the range seen, and those within the noise of
/// it; all with the sign turned on side 1.
void QualityMonitor::WatchExtreme(std::size_t side, const double* x, std::size_t rows, Track& track,
                                  Quality* flags) {
  Extreme& extreme = track.extremes[side];
  const double near = kNearExtreme * Sigma(track);
  const double sign = side == 0 ? 1.0 : -1.0;
  for (std::size_t i = 0; i < rows; ++i) {
    const double reading = sign * x[i];
    if (reading > extreme.value) {
      extreme = {reading, 1, 0, false};
    } else if (reading == extreme.value) {
      ++extreme.at;
      // A reading of exactly 0 is what a relieved sensor shows.
      extreme.cut =
          reading != 0 && extreme.at >= kReadingsAtLimit &&
          static_cast<double>(extreme.at) > kShareAtLimit * static_cast<double>(extreme.at + extreme.near);
      if (extreme.cut) flags[i] |= quality::kOutOfRange;
    } else if (reading > extreme.value - near) {
      ++extreme.near;
    }
  }
}

/// Whether noise scatters readings by more than their resolution does, however much the signal moves from row to row: at rest it
/// would scatter them too.
bool QualityMonitor::NoiseShowsUnderMotion(const Track& track) {
  return track.scale >= kOverLeastStep * track.least_step &&
         static_cast<double>(track.third_reversals) >=
             kThirdReversalsOfNoise * static_cast<double>(track.thirds);
}

/// Follows the median: half of the third differences should lie above it. Steps are bounded, so a transient
/// moves it little; a frame almost entirely above it means that the scale is far too small.
void QualityMonitor::BeginFrame(Track& track) {
  const auto changes = static_cast<double>(track.changes);
  const double mean_run = static_cast<double>(track.readings) / changes;
  const bool noisy = static_cast<double>(track.reversals) >= kReversalsOfNoise * changes;
  track.stuck_limit = 0;
  if (track.changes >= kChangesToJudge && mean_run <= kLongestMeanRun &&
      (noisy || NoiseShowsUnderMotion(track)) && track.stuck_rows > 0)
    track.stuck_limit = std::max(track.stuck_rows, static_cast<std::int64_t>(kRunsToBeStuck * mean_run));
  track.changes_often =
      track.changes >= kChangesToJudge && mean_run <= kLongestMeanRunOfReadings && track.can_saturate;
  track.held_limit = track.stuck_limit;
  const double repeats = std::max(1.0, static_cast<double>(track.repeated_runs)) / changes;
  if (noisy && track.stuck_limit > 0 && track.can_saturate && repeats <= kLargestShareOfRuns)
    track.held_limit = std::min(
        track.stuck_limit,
        std::max(kShortestHold - 1, static_cast<std::int64_t>(std::log(kRareRun) / std::log(repeats))));
  if (track.first_count < kFrame) return;
  if (track.scale == 0) {
    auto first = track.first;
    std::nth_element(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(kFrame / 2), first.end());
    track.scale = first[kFrame / 2];
    track.settled = true;
  } else if (track.different >= static_cast<std::int64_t>(kFrame / 2)) {
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
