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

/// When a pressure counts as cut off. Noise is that of pieces of ten readings from their third differences; of white noise one in
/// 8 000 pieces has less than 0.15 of the median, and 6.5 % have less than half of it. That no healthy log is accused, and which cut
/// off ones are found, holds pipeline/log_faults/cut_off_test.cc.
struct SaturationOptions {
  std::size_t fewest = 30;  ///< pieces at the level, and away from it: some tenths of a second at usual rates
  std::size_t entries = 3;  ///< times that the pressure comes to it: a single stroke may well have a flat top
  float away = 0.05F;       ///< of the range: so far below the highest reading noise is what it is
  float band = 0.5F;    ///< noises below the highest reading: the level, for what is cut off hardly scatters
  float quiet = 0.15F;  ///< of the noise, that is left there at most: hardly ever by chance
  float noisy = 0.5F;   ///< of the noise, with which it comes there
  double nearly_all = 0.9;  ///< of the pieces at the level are quiet: a relief valve leaves noise
  double moves = 8;  ///< noises by which a position that moves goes on in a piece: noise alone does not
};

/// Finds pressures that are cut off before the last of their noise is added, so that no two readings need be equal: while the
/// machine moves, time and again, they come to their highest level with all of their noise and have next to none there. A relief
/// valve leaves them their noise, and at rest a supply may well be quiet, so neither is one.
class SaturatedPressures {
 public:
  /// `machine` must outlive it.
  explicit SaturatedPressures(const Machine& machine, const SaturationOptions& options = {});
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
  SaturationOptions options_;
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
