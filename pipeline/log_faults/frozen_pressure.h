#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "acquisition/quality_monitor.h"
#include "core/records/sample_block.h"
#include "core/told.h"
#include "models/machine.h"

namespace hydroscope {

/// When a pressure counts as frozen. Of 236 healthy logs of random machines (60 s each; 200 with rows 2 ms apart and noise of 0.2 to 2
/// times that of the rig, 12 each with 1, 5 and 10 ms) none holds a step of 9 noises, one has two of 8. Of 200 in which p_A freezes for
/// 0.5 s of a stroke it is found in 132, all but 20 of those where the pressure moved by 10 noises meanwhile.
struct FrozenPressureOptions {
  double step = 10;      ///< noises by which it jumps at the end, means of five readings on either side
  double at_once = 0.6;  ///< of the step, between two neighbouring readings
  double on = 0.25;      ///< of the step, that it goes on by over the five readings behind; or `still`
  double still = 3;      ///< noises that it moves by over the five readings before
  double level = 4.5;  ///< standard deviations of means of ten readings about that of those behind: one level
  int least = 50;      ///< rows of one level before the step
  double moves = 8;    ///< noises by which the position moves over these rows
};

/// Readings of a pressure that had stopped, though their noise went on.
struct FrozenStretch {
  std::size_t signal = 0;
  double begin = 0, end = 0;  ///< s, of the log
};

/// Finds where a pressure stands still under its noise while the machine moves, and then jumps within a row to where it would have been: a
/// sensor, an amplifier or a bus that hung for a moment, with noise from what reads it. A pressure that did not move meanwhile
/// shows none of it, and does no harm.
class FrozenPressures {
 public:
  /// `machine` must outlive it.
  explicit FrozenPressures(const Machine& machine, const FrozenPressureOptions& options = {});
  /// Rows as they come, with the noise known so far (QualityMonitor::channels).
  void Observe(const SampleBlock& block, const std::vector<ChannelQuality>& channels);
  const std::vector<FrozenStretch>& Found() const { return found_; }

 private:
  struct Track {
    std::size_t signal = 0;
    std::vector<double> readings;
  };
  bool Jumps(const Track& track, std::size_t row, double noise) const;
  std::size_t RowsOfOneLevel(const Track& track, std::size_t row, double noise) const;
  void Look(const Track& track, std::size_t row, const std::vector<ChannelQuality>& channels);
  void Forget();

  static constexpr std::size_t kBeside = 5;      ///< readings on either side of a step
  static constexpr std::size_t kPiece = 10;      ///< readings in a mean
  static constexpr std::size_t kKept = 1 << 12;  ///< rows that a stretch is sought back over
  FrozenPressureOptions options_;
  std::size_t position_ = 0;  ///< signal that moves with the machine
  std::vector<double> times_, positions_;
  std::vector<Track> tracks_;
  std::vector<FrozenStretch> found_;
};

/// Flags these readings kStuck.
void FlagFrozen(std::span<const FrozenStretch> frozen, SampleBlock& block);

/// A sentence for each signal that had some.
std::vector<Told> FrozenTexts(std::span<const FrozenStretch> frozen, const Machine& machine);

}  // namespace hydroscope
