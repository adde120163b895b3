#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/standing_output.h"
#include "acquisition/standstill.h"
#include "core/records/sample_block.h"
#include "models/expressions/guard.h"
#include "models/machine.h"

namespace hydroscope {

/// What the values of one channel looked like so far.
struct ChannelQuality {
  std::string name;
  std::int64_t rows = 0;                   ///< rows inspected
  std::array<std::int64_t, 16> flagged{};  ///< values per quality flag (bit number), whoever set it
  /// SI, white sensor noise; NaN until 64 values changed.
  double noise_std = std::numeric_limits<double>::quiet_NaN();
  /// SI, highest and lowest reading where the noise is cut off there: a sensor or converter at its limit; NaN where it is not.
  std::array<double, 2> cut_off = {std::numeric_limits<double>::quiet_NaN(),
                                   std::numeric_limits<double>::quiet_NaN()};
  double first_bad = std::numeric_limits<double>::quiet_NaN();  ///< s, first value with any flag; NaN if none
  double last_bad = std::numeric_limits<double>::quiet_NaN();   ///< s
};

/// Flags values that cannot be right, row by row, on any number of channels; neither blocks nor allocates per
/// row and does not depend on how rows are cut into blocks.
///
///   kOutOfRange  outside min/max of the machine file.
///   kStuck       the very same reading for longer than `stuck_time` (and 25 times longer than on average),
///                all of them as far as rows are still held back, else from that moment on. Only on a
///                channel whose noise its resolution does not hide: at least 100 changes
///                of reading seen, two in three readings different from the one before, and three in ten
///                changes back in the direction they came from (white noise: two in three; smooth motion:
///                none), or under faster motion noise of two steps of its resolution and more, whose third
///                differences change their sign from row to row. A command that rests at one value between noisy phases needs `stuck_time = 0`.
///                Where next to no reading repeats the one before, also a run of at least four that chance makes once in
///                ten million readings: what a logger holds where it got none.
///                Also a run of readings between a step in and a step out again that are as sharp as a spike's, on a
///                channel that changes at least every tenth row: a gap that a logger filled with 0 or another constant.
///                Also a signal that stands still while what drives it moves (acquisition/standstill.h), all its
///                equal readings where it repeats one bit for bit, and the output of a closed loop that repeats one
///                while its set point moves (acquisition/standing_output.h).
///   kOutOfRange  as well: a reading exactly at the highest or lowest one seen, where so many pile up that the
///                noise is cut off there: a sensor or converter at its limit. On channels whose noise shows.
///   kExpression  an expression of the machine file is no finite number on this row (models/expressions/guard.h).
///   kSpike       one value off the mean of its neighbours by more than 12 standard deviations of that
///   distance and by
///                3 times each of the steps around it: between its neighbours, into the one before, out of
///                the one after (peaks of oscillations and corners of commands are not). Values beside a gap
///                or a missing value are not judged. Also two to four readings between such steps away and back, on a
///                channel that changes at least every tenth row.
///
/// Noise scale: median of the third differences other than zero (they cancel parabolic motion), followed in
/// frames of 64 rows; sigma = median / (0.6745 sqrt(20)) for white noise.
///
/// A spike can only be told two rows later, a pulse of a few rows after it has ended, and a signal that stands still only after
/// `stuck_time`: the monitor holds back two rows, after a sharp step until it is no pulse, and the rows of a run of one reading
/// as long as it may turn out to be stuck, so that the first ones are flagged as well. Inspect gives out what need not be held
/// any longer, Flush the last rows at the end of a log.
class QualityMonitor {
 public:
  /// `sample_period` in s.
  QualityMonitor(const Machine& machine, double sample_period);

  /// Adds flags to `block.quality`. Afterwards `block` holds the rows to be processed, delayed: fewer than came
  /// (perhaps none), or more where a run has ended.
  void Inspect(SampleBlock& block);
  /// Fills `block` with the rows held back.
  void Flush(SampleBlock& block);

  /// One per signal of the machine, over the rows given out so far.
  const std::vector<ChannelQuality>& channels() const { return channels_; }

 private:
  static constexpr std::size_t kFrame = 64;        ///< rows between two updates of the noise scale
  static constexpr std::size_t kHistory = 2;       ///< rows remembered before the first one to be given out
  static constexpr std::size_t kAhead = 2;         ///< rows to be seen after one before it can be judged
  static constexpr std::size_t kLongestPulse = 4;  ///< rows
  static constexpr std::size_t kMostHeld = 1024;

  /// Median of |third difference| of white noise of standard deviation 1: 0.6745 sqrt(1 + 9 + 9 + 1).
  static constexpr double kMedianThirdDifference = 3.0165;
  /// Standard deviation of the distance to the mean of both neighbours: sqrt(1 + 1/4 + 1/4), here of twice it.
  static constexpr double kTwiceDistanceStd = 2.4495;
  static constexpr double kSpikeStd = 12.0;
  static constexpr double kSpikeOverNeighbours = 3.0;

  /// One end of a channel's range.
  struct Extreme {
    double value = 0;               ///< SI, the farthest reading seen
    std::int64_t at = 0, near = 0;  ///< readings exactly there, and within the noise of it
    bool cut = false;               ///< the noise is cut off there
  };

  /// What is remembered of a channel.
  struct Track {
    double low = 0, high = 0;               ///< SI, limits
    double known_noise = 0;                 ///< SI, std from the machine file; 0 if not given
    std::int64_t stuck_rows = 0;            ///< identical readings allowed; 0: any number
    std::size_t held_run = 0;               ///< rows of a run of one reading that are held back at most
    std::array<double, kHistory> before{};  ///< the last readings given out, oldest first
    std::vector<double> held;
    std::vector<Quality> held_quality;
    std::array<Extreme, 2> extremes{};           ///< highest, lowest with its sign turned
    bool is_marker = false;                      ///< Machine::episode_marker: it rests, and it jumps
    bool can_saturate = true;                    ///< a measurement, not a command that rests at its limit
    std::array<std::size_t, kAhead + 1> runs{};  ///< identical readings up to each of the last rows that came
    double last = 0;                             ///< of these
    std::int64_t run = 0;                        ///< identical readings up to the last row given out
    unsigned steps = 0;  ///< whether a sharp step led to each of the last rows, newest lowest
    // Counted over all rows, and as they stood when the present frame began.
    std::int64_t readings = 0, changes = 0, reversals = 0;
    std::int64_t thirds = 0,
                 third_reversals = 0;  ///< third differences other than zero; of the other sign than the next
    double least_step = std::numeric_limits<double>::infinity();  ///< of readings that differ
    std::int64_t repeated_runs = 0;  ///< runs of at least two identical readings, among `changes` runs
    std::int64_t stuck_limit = 0;    ///< readings; 0: the channel cannot be judged
    std::int64_t held_limit = 0;     ///< as stuck_limit, by the chance of such a run; no more than that
    bool changes_often = false;      ///< a run between two steps is no command
    // Counted over the present frame.
    std::int64_t different = 0, above = 0;
    double scale = 0;                    ///< median of |third difference|; 0 until known
    bool settled = false;                ///< the scale fitted the frame before
    std::array<double, kFrame> first{};  ///< third differences until the scale is known
    std::size_t first_count = 0;
  };

  void Reserve(std::size_t rows);
  void LineUp(const SampleBlock& block, std::size_t channel);
  void Judge(std::size_t begin, std::size_t end, Track& track);
  void GiveOut(std::size_t rows, std::size_t kept, std::size_t channel, SampleBlock& block);
  void DelayTimes(std::size_t rows, std::size_t kept, std::vector<double>& time);
  void JudgeStandstill(SampleBlock& block);
  void FlagHeld(std::size_t signal, std::size_t rows);
  std::size_t RunUnderWay(const SampleBlock& block);
  std::size_t PulseUnderWay(const SampleBlock& block);
  void CollectFirst(const double* x, std::size_t rows, Track& track);
  void FlagRange(const double* x, std::size_t rows, const Track& track, Quality* flags);
  void FlagStuck(const double* x, std::size_t rows, Track& track, Quality* flags);
  bool IsFilledGap(const double* after, std::int64_t run, const Track& track) const;
  void FlagBack(Quality* at, std::int64_t rows, Quality flag);
  void WatchExtreme(std::size_t side, const double* x, std::size_t rows, Track& track, Quality* flags);
  void FlagSpikes(const double* x, std::size_t rows, const Track& track, Quality* flags);
  void FlagPulses(const double* x, std::size_t rows, const Track& track, Quality* flags);
  static double Sigma(const Track& track);
  static double LeastStep(const Track& track);
  static double LeastSpike(const Track& track);
  static bool NoiseShowsUnderMotion(const Track& track);
  void BeginFrame(Track& track);
  void CountFlags(const SampleBlock& block, std::size_t rows);

  std::vector<Track> tracks_;
  std::shared_ptr<const ExpressionGuard> guard_;  ///< nullptr: no expression can fail
  std::vector<ChannelQuality> channels_;
  std::vector<double> column_;  ///< history, rows held back, new rows of the channel being judged
  std::vector<Quality> flags_;  ///< of the same rows without history
  std::size_t frame_row_ = 0;   ///< rows given out in the present frame
  std::size_t held_ = 0;        ///< rows held back at present, the last kAhead of them not judged yet
  std::size_t hold_ = kAhead + kLongestPulse;  ///< rows held back at most
  std::size_t longest_gap_ = 0;                ///< rows that a logger may have filled with a constant
  std::vector<double> held_time_, times_;      ///< s; of rows held back, and with those that came
  std::optional<Standstill> standstill_;    ///< nothing: no signal of this machine is known to follow another
  std::optional<StandingOutput> standing_;  ///< nothing: it is not driven in closed loop
};

}  // namespace hydroscope
