#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/log_bins.h"
#include "core/records/sample_block.h"

namespace hydroscope {

/// Finds readings that no sensor gave: a logger that got none drew a straight line from the one before to the one after. A run of
/// readings without a bend counts as drawn if the noise of its channel makes such a one once in a hundred million readings; at
/// least two readings. Only channels whose noise shows are judged: where neighbouring bends often have opposite signs, which those
/// of motion, ramps and compressed readings have not. What bends by no more than rounding does not bend.
///
/// Whether the last readings of a block are drawn is seen later: they are held back. Results do not depend on how rows are cut
/// into blocks, but for what the noise is like, which is counted block by block.
class StraightRuns {
 public:
  explicit StraightRuns(std::size_t signals);
  /// Adds kInterpolated to such readings. Afterwards `block` holds the rows to be processed, delayed by a few.
  void Inspect(SampleBlock& block);
  /// Fills `block` with the rows held back.
  void Flush(SampleBlock& block);

 private:
  static constexpr LogBins kBins{.per_octave = 2, .least_exponent = -64, .count = 256};  ///< of bends
  struct Channel {
    double last = 0;        ///< SI, of the rows given out
    std::size_t drawn = 0;  ///< readings of the run that the last ones given out belong to, if they are drawn
    double least_step = 0;  ///< the smallest so far: the resolution; 0: none yet
    double straight = 0;    ///< the largest bend that is none
    std::int64_t readings = 0;  ///< looked at
    std::int64_t alone = 0;     ///< without a bend between two that have one: how often chance makes one
    std::int64_t bent = 0;      ///< with a bend ...
    std::int64_t turned = 0;    ///< ... against that of the reading before
    std::array<std::int64_t, kBins.count> bends{};  ///< their number by size
    std::size_t fewest = 0;  ///< readings of a run that counts; 0: the channel cannot be judged
  };
  static void Learn(const std::vector<double>& coming, Channel& channel);
  static void Judge(Channel& channel);
  /// Flags the runs of one channel; gives the readings at the end of which nothing is known yet.
  static std::size_t Flag(const std::vector<double>& values, Channel& channel, std::vector<Quality>& flags);

  std::vector<Channel> channels_;
  SampleBlock held_;
};

}  // namespace hydroscope
