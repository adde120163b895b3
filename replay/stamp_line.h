#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace hydroscope {

/// Times of rows that are one period apart, but for breaks.
struct StampLine {
  /// Rows one period after the other, up to the next piece.
  struct Piece {
    std::int64_t first = 0;  ///< row
    double time = 0;         ///< s, of that row: stamps less their mean distance from a straight line
  };

  double period = 0;  ///< s
  std::vector<Piece> pieces;
};

/// The straight line about which the `times` (s) that rows are stamped with lie, each piece between breaks with a beginning of
/// its own: where the clock jumps, and where rows are missing, so that the stamps are displaced from there on. Nothing if stamps
/// lie farther from it than windows of some hundred rows let expect, or if these are fewer than four.
std::optional<StampLine> LineThrough(const std::vector<double>& times);

}  // namespace hydroscope
