#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/records/sample_block.h"
#include "core/records/stroke_record.h"
#include "estimation/span_equations.h"
#include "estimation/stroke_conditions.h"
#include "models/episode_marker.h"
#include "models/machine.h"
#include "models/model_structure.h"

namespace hydroscope {

/// Cuts a stream of samples into strokes and strokes into stretches of good samples inside the gate.
///
/// Samples are taken block by block; a bad value in a needed channel, a gap or a clock jump ends the segment
/// and restarts the block grid. The gate looks at block means (and at their rate over half a window of flows,
/// at least two blocks, to either side, hence a delay of as many), so that sensor noise does not decide which
/// samples are used. Time outside the gate longer than `GateSpec::stroke_gap` ends the stroke, and so does a
/// change of sign under an abs(...) of the gate: on its way the magnitude was zero. A stroke that has lasted
/// `GateSpec::max_stroke` ends, and the next begins with the block after. So does one whose Machine::episode_marker
/// changes: the row of the change begins a block of its own.
class StrokeSegmenter {
 public:
  struct Sink {
    /// One stretch: whole blocks, a full span or the rest of a segment. `begin` is its first new sample's time.
    std::function<void(Stretch&, double begin)> on_stretch;
    /// The stroke whose stretches were given is over.
    std::function<void(const StrokeSummary&)> on_stroke;
    /// The stroke was shorter than GateSpec::min_stroke: forget its stretches.
    std::function<void()> on_discard;
  };

  StrokeSegmenter(const Machine& machine, std::shared_ptr<const ModelStructure> model, WindowSamples window,
                  Sink sink);

  /// Blocks to either side that a rate of the gate is taken over.
  static int GateReach(const WindowSamples& window);

  void Process(const SampleBlock& block);
  /// End of the log: whatever is under way is finished.
  void Finish();

  /// Rows seen and used since the start.
  const StrokeCounters& totals() const { return totals_; }
  /// s for which the gate has been closed in a stroke that is not over yet; 0 while it is open and between strokes.
  double closed_for() const { return in_stroke_ ? closed_for_ : 0; }
  /// Strokes shorter than GateSpec::min_stroke.
  std::int64_t discarded_strokes() const { return discarded_; }

 private:
  struct Pending {               ///< a block waiting for its gate decision
    std::vector<double> sample;  ///< [channel][row]
    std::vector<double> mean;    ///< per machine signal the gate looks at
    double begin = 0;            ///< s
  };
  struct Bound {
    int slot;  ///< index into Pending::mean
    bool rate, magnitude;
    double min, max;
  };

  void CollectFlags(const SampleBlock& block);
  void TakeFlaggedRow(const SampleBlock& block, std::size_t row);
  void TakeGoodRows(const SampleBlock& block, std::size_t first, std::size_t last);
  void Fill(const SampleBlock& block, std::size_t first, int count);
  void CompleteBlock();
  void Decide(int index);
  /// Whether the stroke has lasted max_stroke when block `index` begins.
  bool LongEnough(int index) const;
  /// Whether all bounds hold; notes the signs of those on a magnitude in `direction_`.
  bool GateOpen(int index);
  void Break();
  /// Block `index` of the ring is part of the stretch.
  void Append(int index);
  /// Puts blocks of the ring from `first` on, `count` of them, into the stretch from sample `at` on.
  void CopyBlocks(int first, int count, int at);
  void EndSegment();
  void Emit();
  void CountOutside(double time);
  void EndStroke();
  void AddToTotals();

  std::shared_ptr<const ModelStructure> model_;
  WindowSamples window_;
  GateSpec gate_;
  Sink sink_;
  int reach_;  ///< blocks to either side that a rate of the gate is taken over
  std::vector<Bound> bounds_;
  std::vector<int> gate_signal_;  ///< machine signal of each slot
  std::vector<bool> needed_;      ///< per machine signal
  EpisodeMarker marker_;
  std::vector<Pending> ring_;  ///< the last 2 reach_ + 1 blocks; ring_[pending_ - 1] is the newest
  int pending_ = 0, undecided_ = 0;
  Pending filling_;
  int rows_in_block_ = 0;
  std::vector<Quality> row_flags_;  ///< flags of all signals of each row of the block being processed
  /// Last good value of each channel, for channels the base model does not need, and for how many samples it is held.
  std::vector<double> held_;
  std::vector<int> held_for_;
  /// Samples a bad value is bridged at most; then the channel is NaN, and what needs it is not judged.
  int hold_ = 0;
  Stretch stretch_;
  int stretch_blocks_ = 0;
  int next_block_ = 0;  ///< block of the ring that follows the stretch, while there is one
  double stretch_begin_ = 0;
  std::optional<double> first_begin_;  ///< s, of the first stretch: the origin of Stretch::begin
  bool in_stroke_ = false;
  std::uint32_t direction_ = 0,
                stroke_direction_ = 0;  ///< signs under abs(...) of this block, of the stroke's last
  double last_gated_ = 0, closed_for_ = 0;
  StrokeSummary summary_;
  StrokeConditions conditions_;
  double stroke_blocks_ = 0;  ///< inside the gate, of the stroke under way
  std::int64_t next_index_ = 0, discarded_ = 0;
  StrokeCounters totals_, since_stroke_;
};

}  // namespace hydroscope
