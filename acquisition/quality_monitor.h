#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/sample_block.h"
#include "models/machine.h"

namespace hydroscope {

/// What the values of one channel looked like so far.
struct ChannelQuality {
  std::string name;
  std::int64_t rows = 0;                   ///< rows inspected
  std::array<std::int64_t, 16> flagged{};  ///< values per quality flag (bit number), whoever set it
  double noise_std =
      std::numeric_limits<double>::quiet_NaN();  ///< SI, white sensor noise; NaN until 64 values changed
  double first_bad = std::numeric_limits<double>::quiet_NaN();  ///< s, first value with any flag; NaN if none
  double last_bad = std::numeric_limits<double>::quiet_NaN();   ///< s
};

/// Flags values that cannot be right, row by row, on any number of channels; neither blocks nor allocates per
/// row and does not depend on how rows are cut into blocks.
///
///   kOutOfRange  outside min/max of the machine file.
///   kStuck       the very same reading for longer than `stuck_time`, from that moment on. Only on a channel
///   that is
///                noisy: at least 100 changes of reading seen, three in ten of them back in the direction
///                they came from (white noise: two in three; smooth motion: none), and the reading has stayed
///                25 times longer than on average, which a coarsely quantised channel does not exceed by
///                chance. A command that rests at one value between noisy phases needs `stuck_time = 0`.
///   kSpike       one value off the mean of its neighbours by more than 12 standard deviations of that
///   distance, by
///                3 times the distance between the neighbours, and by 3 times the step before it (the peak of
///                an oscillation is none of these). Values beside a gap or a missing value are not judged.
///
/// Noise scale: median of the third differences other than zero (they cancel parabolic motion), followed in
/// frames of 64 rows; sigma = median / (0.6745 sqrt(20)) for white noise.
///
/// A spike can only be told one row later, so the monitor holds back one row: Inspect gives out the row it
/// held back and all rows but the last. At the end of a log, Flush gives out the last one.
class QualityMonitor {
 public:
  /// `sample_period` in s.
  QualityMonitor(const Machine& machine, double sample_period);

  /// Adds flags to `block.quality`. Afterwards `block` holds the rows to be processed: those of this block
  /// delayed by one row, one less at the very first call.
  void Inspect(SampleBlock& block);
  /// Fills `block` with the row held back: one row, or none.
  void Flush(SampleBlock& block);

  /// One per signal of the machine, over the rows given out so far.
  const std::vector<ChannelQuality>& channels() const { return channels_; }

 private:
  static constexpr int kFrame = 64;   ///< rows between two updates of the noise scale
  static constexpr int kHistory = 2;  ///< rows kept before the first one to be given out

  /// What is remembered of a channel.
  struct Track {
    double low = 0, high = 0;               ///< SI, limits
    double known_noise = 0;                 ///< SI, std from the machine file; 0 if not given
    std::int64_t stuck_rows = 0;            ///< identical readings allowed; 0: any number
    std::array<double, kHistory> before{};  ///< the last readings given out, oldest first
    double held = 0;
    Quality held_quality = 0;
    std::int64_t run = 0;  ///< identical readings up to the last row given out
    // Counted over all rows, and as they stood when the present frame began.
    std::int64_t readings = 0, changes = 0, reversals = 0;
    std::int64_t stuck_limit = 0;  ///< readings; 0: the channel cannot be judged
    // Counted over the present frame.
    std::int64_t different = 0, above = 0;
    double scale = 0;                    ///< median of |third difference|; 0 until known
    bool settled = false;                ///< the scale fitted the frame before
    std::array<double, kFrame> first{};  ///< third differences until the scale is known
    int first_count = 0;
  };
  struct Counts;

  void InspectRows(SampleBlock& block, std::size_t rows, bool last_row_known);
  void TakeColumn(SampleBlock& block, std::size_t channel, std::size_t rows);
  Counts Count(const double* x, std::size_t rows, const Track& track) const;
  void CollectFirst(const double* x, std::size_t rows, Track& track);
  void FlagRange(const double* x, std::size_t rows, const Track& track, Quality* flags);
  void FlagStuck(const double* x, std::size_t rows, Track& track, Quality* flags);
  void FlagSpikes(const double* x, std::size_t rows, const Track& track, Quality* flags);
  void BeginFrame(Track& track);
  void CountFlags(const SampleBlock& block, std::size_t rows);

  double sample_period_;  ///< s
  std::vector<Track> tracks_;
  std::vector<ChannelQuality> channels_;
  std::vector<double> column_;  ///< history, rows to give out, the row after them
  std::vector<Quality> flags_;  ///< of the rows to give out and the row after them
  std::int64_t frame_row_ = 0;  ///< rows given out in the present frame
  bool holding_ = false;
  double held_time_ = 0;  ///< s
};

}  // namespace hydroscope
