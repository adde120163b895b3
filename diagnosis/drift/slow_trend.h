#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "core/bytes.h"

namespace hydroscope::drift {

/// A slow, steady drift and when it reaches a limit.
struct TrendFigures {
  double slope = 0, slope_std = 0;  ///< SI per stroke
  double now = 0;                   ///< SI, deviation at the last stroke on the fitted line
  std::int64_t strokes = 0;         ///< the line is fitted over
  bool significant = false;         ///< slope stands out, and what it adds up to is worth telling
};

/// Strokes until the line reaches `limit`, with the 95 % interval that the slope leaves; infinite = never.
struct TimeToLimit {
  double strokes = 0, low = 0, high = 0;
};

/// Straight line through block means of deviations (a block is DriftThresholds::block_strokes judged strokes; the last
/// `blocks` are kept). Scatter of the blocks about the line beyond their own std, and correlation of neighbouring
/// blocks, widen the slope's uncertainty (effective number of blocks, Bayley and Hammersley 1946).
class SlowTrend {
 public:
  void Add(std::int64_t sequence, double deviation, double std);
  TrendFigures Figures(double smallest, double doubt) const;
  static TimeToLimit Reach(const TrendFigures& figures, double limit);

  void Save(ByteWriter& out) const;
  bool Restore(ByteReader& in);

 private:
  struct Block {
    double sequence = 0, value = 0, std = 0;
  };
  std::deque<Block> blocks_;
  double weight_ = 0, sum_ = 0, sequence_sum_ = 0;
  std::int32_t count_ = 0;
};

}  // namespace hydroscope::drift
