#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "acquisition/quality_monitor.h"
#include "core/log_bins.h"
#include "core/records/sample_block.h"
#include "core/told.h"
#include "models/machine.h"

namespace hydroscope {

/// Readings of a log that are wrong though no single one shows it, found as the rows pass with their flags set:
///   - a signal with inertia (of a Condition::Of::kMeanRate) that jumps time and again, and stays there: by five times what it
///     moves in nine rows of ten, and five times what it moves in the rows beside. A counter that overflows or loses steps
///     does; its readings are off by an unknown distance.
///   - a measurement that repeats the command it follows (StandstillRule) to a ten thousandth of its range, offset and scale
///     aside: nothing is measured there.
class ReadingFaults {
 public:
  /// `sample_period` in s.
  ReadingFaults(const Machine& machine, double sample_period);
  /// `channels`: of the quality monitor, whose noise no jump is.
  void Observe(const SampleBlock& block, const std::vector<ChannelQuality>& channels);

  /// Why nothing can be concluded from these readings, a sentence; "" if nothing speaks against it.
  Told NoVerdict() const;
  /// Signals that are their command: what lies between command and movement looks like other signals being late.
  struct Echo {
    std::string signal, command;
    Told Sentence() const;
  };
  std::vector<Echo> Echoes() const;

 private:
  static constexpr LogBins kBins{.per_octave = 4, .least_exponent = -40, .count = 256};  ///< of steps
  /// Readings on either side of a jump that tell whether the signal stays where it jumped to: more than a burst of disturbance.
  static constexpr std::size_t kBeside = 10;
  struct Track {
    std::size_t signal = 0;
    std::array<double, 2 * kBeside> values{}, times{};     ///< SI, s: of the last good readings on end
    std::size_t readings = 0;                              ///< so many of them, at the end
    std::array<std::int64_t, kBins.count> all{}, sharp{};  ///< steps by size
    std::array<double, kBins.count> first{};               ///< s, of the sharp ones
  };
  static void Follow(double time, double value, double reach, Track& track);
  static bool StaysAfterTheMiddle(const Track& track);
  struct Jumps {
    std::int64_t count = 0;
    double first = 0, size = 0;  ///< s, SI
  };
  static Jumps JumpsOf(const Track& track);
  /// Sums over rows in which both are good, about the first such row.
  struct Pair {
    std::size_t signal = 0, command = 0;
    double signal_at = 0, command_at = 0;
    std::int64_t rows = 0;
    double x = 0, y = 0, xx = 0, yy = 0, xy = 0;
    bool IsEcho() const;
  };
  const Machine& machine_;
  double period_;
  std::vector<Track> tracks_;
  std::vector<Pair> pairs_;
};

}  // namespace hydroscope
