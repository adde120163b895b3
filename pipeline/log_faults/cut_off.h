#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "acquisition/quality_monitor.h"
#include "core/records/sample_block.h"
#include "core/told.h"
#include "models/machine.h"

namespace hydroscope {

/// An end of the range of a sensor, its amplifier or its converter, at which readings of a whole log pile up.
struct CutOff {
  std::size_t signal = 0;
  bool upper = true;
  double from = 0;      ///< SI, readings from here on are not measured
  bool narrow = false;  ///< they are not equal: what noise they have comes from behind the limit
  Told text;            ///< that says so
};

/// Finds pressures that are cut off before the last of their noise is added, so that no two readings need be equal: while the
/// machine moves, time and again, they come to their highest level with all of their noise and have next to none there. A relief
/// valve leaves them their noise, and at rest a supply may well be quiet, so neither is one.
class SaturatedPressures {
 public:
  /// `machine` must outlive it.
  explicit SaturatedPressures(const Machine& machine);
  /// Rows as they come, flags set.
  void Observe(const SampleBlock& block);
  std::vector<CutOff> Found() const;

 private:
  /// Of kRows readings of one pressure.
  struct Piece {
    float low = 0, high = 0;  ///< Pa
    float noise = 0;          ///< Pa, of white noise with the same third differences
    bool moves = false;       ///< the machine does
  };
  struct Track {
    std::size_t signal = 0;
    std::vector<Piece> pieces;
  };
  void EndPiece();
  void Thin();
  std::vector<CutOff> Found(const Track& track) const;

  static constexpr std::size_t kRows = 10;
  static constexpr std::size_t kMostPieces = 1
                                             << 18;  ///< kept; of longer logs every second, fourth, ... piece
  const Machine& machine_;
  std::size_t position_ = 0;  ///< signal that moves with the machine
  std::size_t filled_ = 0;
  std::size_t ended_ = 0, stride_ = 1;     ///< pieces; one in so many is kept
  std::vector<std::vector<double>> last_;  ///< the readings of the piece under way, position first
  std::vector<Track> tracks_;
};

/// Of the channels that QualityMonitor saw the noise cut off of (ChannelQuality::cut_off).
std::vector<CutOff> CutOffsOf(const std::vector<ChannelQuality>& channels, const Machine& machine);

/// The machine with limits of its signals that leave no reading of these in.
Machine Within(Machine machine, std::span<const CutOff> cut_offs);

}  // namespace hydroscope
