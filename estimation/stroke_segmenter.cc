#include "estimation/stroke_segmenter.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/constants.h"

namespace hydroscope {
namespace {

constexpr int kLeastReach = 2;     ///< blocks of a gate rate to either side: one alone is noise
constexpr int kBeyond = 2;         ///< blocks kept of what was measured before and after a stretch
constexpr double kHoldTime = 0.1;  ///< s
/// Flags that say a row does not follow the one before at the sample period.
constexpr Quality kTimeBroken =
    quality::kGap | quality::kTimeBackwards | quality::kClockJump | quality::kDuplicate;
/// ... and after which it may begin anew with that row itself. A copy of another row is none.
constexpr Quality kBegins = kTimeBroken & static_cast<Quality>(~quality::kDuplicate);

}  // namespace

StrokeSegmenter::StrokeSegmenter(const Machine& machine, std::shared_ptr<const ModelStructure> model,
                                 WindowSamples window, Sink sink)
    : model_(std::move(model)),
      window_(window),
      gate_(machine.gate),
      sink_(std::move(sink)),
      reach_(GateReach(window)),
      marker_(machine),
      conditions_(*model_) {
  needed_.assign(machine.signals.size(), false);
  for (int signal : model_->needed_signals) needed_[signal] = true;
  for (const GateBound& bound : gate_.bounds) {
    const int signal = machine.SignalIndex(bound.signal);
    if (signal < 0) continue;  // BuildModel and the loader refuse unknown signals
    needed_[signal] = true;
    auto slot = std::ranges::find(gate_signal_, signal);
    if (slot == gate_signal_.end()) slot = gate_signal_.insert(slot, signal);
    bounds_.push_back({static_cast<int>(slot - gate_signal_.begin()), bound.rate, bound.magnitude,
                       bound.min.value_or(-kInfinity), bound.max.value_or(kInfinity)});
  }
  const std::size_t channels = model_->channel_source.size();
  Pending empty;
  empty.sample.resize(channels * window_.block);
  empty.mean.resize(gate_signal_.size());
  ring_.assign(2 * reach_ + 1, empty);
  filling_ = empty;
  held_.assign(channels, std::numeric_limits<double>::quiet_NaN());
  held_for_.assign(channels, 0);
  hold_ = static_cast<int>(std::lround(kHoldTime / window_.period));
  const int capacity = (kBeyond + window_.span + kBeyond) * window_.block + 1;
  stretch_.period = window_.period;
  stretch_.channel.assign(model_->channel_names.size(), std::vector<double>(capacity));
  stretch_.samples = 0;
}

int StrokeSegmenter::GateReach(const WindowSamples& window) {
  return std::max(kLeastReach, window.half_window);
}

void StrokeSegmenter::Process(const SampleBlock& block) {
  CollectFlags(block);
  const std::size_t rows = block.rows();
  for (std::size_t row = 0; row < rows;) {
    std::size_t last = row;
    bool changes = false;
    while (last < rows && !(changes = marker_.Changes(block.signal, last)) &&
           row_flags_[last] == quality::kGood)
      ++last;
    TakeGoodRows(block, row, last);
    if (changes) {
      Break();
      if (in_stroke_) EndStroke();
    }
    if (last < rows && row_flags_[last] != quality::kGood) TakeFlaggedRow(block, last++);
    row = last;
  }
}

void StrokeSegmenter::CollectFlags(const SampleBlock& block) {
  row_flags_.assign(block.rows(), quality::kGood);
  for (const std::vector<Quality>& flags : block.quality)
    for (std::size_t row = 0; row < flags.size(); ++row) row_flags_[row] |= flags[row];
}

void StrokeSegmenter::TakeFlaggedRow(const SampleBlock& block, std::size_t row) {
  ++since_stroke_.samples;
  bool bad = false;
  for (std::size_t s = 0; s < block.signal.size(); ++s) {
    const Quality flags = block.quality[s][row];
    for (Quality rest = flags; rest != 0; rest &= rest - 1) ++since_stroke_.flagged[std::countr_zero(rest)];
    bad = bad || (needed_[s] && (flags & ~kBegins) != 0);
  }
  if (bad || (row_flags_[row] & kTimeBroken) != 0) Break();
  if (bad) {
    CountOutside(block.time[row]);
    return;
  }
  Fill(block, row, 1);
}

void StrokeSegmenter::TakeGoodRows(const SampleBlock& block, std::size_t first, std::size_t last) {
  while (first < last) {
    const int room = window_.block - rows_in_block_;
    const int count = static_cast<int>(std::min<std::size_t>(room, last - first));
    since_stroke_.samples += count;
    Fill(block, first, count);
    first += count;
  }
}

/// Puts rows without a bad needed value into the block being filled, at most as many as it has room for.
void StrokeSegmenter::Fill(const SampleBlock& block, std::size_t first, int count) {
  if (rows_in_block_ == 0) {
    filling_.begin = block.time[first];
    std::ranges::fill(filling_.mean, 0.0);
  }
  for (std::size_t c = 0; c < model_->channel_source.size(); ++c) {
    const int signal = model_->channel_source[c];
    if (signal < 0) continue;
    double* place = &filling_.sample[c * window_.block + rows_in_block_];
    if (needed_[signal] || block.quality[signal][first] == quality::kGood) {
      std::copy_n(&block.signal[signal][first], count, place);
      held_[c] = place[count - 1];
      held_for_[c] = 0;
    } else {  // a flagged row comes alone
      *place = ++held_for_[c] <= hold_ ? held_[c] : std::numeric_limits<double>::quiet_NaN();
    }
  }
  for (std::size_t g = 0; g < gate_signal_.size(); ++g) {
    const double* x = &block.signal[gate_signal_[g]][first];
    for (int k = 0; k < count; ++k) filling_.mean[g] += x[k];
  }
  rows_in_block_ += count;
  if (rows_in_block_ == window_.block) CompleteBlock();
}

void StrokeSegmenter::CompleteBlock() {
  for (double& mean : filling_.mean) mean /= window_.block;
  rows_in_block_ = 0;
  if (pending_ == std::ssize(ring_)) {
    std::rotate(ring_.begin(), ring_.begin() + 1, ring_.end());
    --pending_;
  }
  std::swap(ring_[pending_++], filling_);
  ++undecided_;
  if (undecided_ > reach_) Decide(pending_ - undecided_);
}

void StrokeSegmenter::Decide(int index) {
  --undecided_;
  next_block_ = index;
  if (GateOpen(index)) {
    if (in_stroke_ && (direction_ != stroke_direction_ || LongEnough(index))) EndStroke();
    stroke_direction_ = direction_;
    Append(index);
  } else {
    EndSegment();
    CountOutside(ring_[index].begin + window_.block * window_.period);
  }
}

bool StrokeSegmenter::LongEnough(int index) const {
  const double half_block = 0.5 * window_.block * window_.period;
  return gate_.max_stroke > 0 && ring_[index].begin - summary_.begin > gate_.max_stroke - half_block;
}

bool StrokeSegmenter::GateOpen(int index) {
  direction_ = 0;
  for (const Bound& bound : bounds_) {
    double x = ring_[index].mean[bound.slot];
    if (bound.rate) {
      // Mean of the blocks after minus mean of those before; one-sided at the border of a segment.
      const int first = std::max(0, index - reach_), last = std::min(pending_ - 1, index + reach_);
      const int before = std::max(1, index - first), after = std::max(1, last - index);
      if (last - first < 2) return false;
      double sum_after = 0, sum_before = 0;
      for (int b = last - after + 1; b <= last; ++b) sum_after += ring_[b].mean[bound.slot];
      for (int b = first; b < first + before; ++b) sum_before += ring_[b].mean[bound.slot];
      const double distance = (last - 0.5 * (after - 1)) - (first + 0.5 * (before - 1));
      x = (sum_after / after - sum_before / before) / (distance * window_.block * window_.period);
    }
    if (bound.magnitude) {
      direction_ = 2 * direction_ + (x < 0);
      x = std::abs(x);
    }
    if (!(x >= bound.min && x <= bound.max)) return false;
  }
  return true;
}

void StrokeSegmenter::Break() {
  while (undecided_ > 0) Decide(pending_ - undecided_);
  EndSegment();
  pending_ = next_block_ = 0;
  rows_in_block_ = 0;
}

void StrokeSegmenter::CopyBlocks(int first, int count, int at) {
  const int m = window_.block;
  for (int b = 0; b < count; ++b)
    for (std::size_t c = 0; c < model_->channel_source.size(); ++c)
      std::copy_n(&ring_[first + b].sample[c * m], m, stretch_[static_cast<int>(c)] + at + b * m);
}

void StrokeSegmenter::Append(int index) {
  const Pending& block = ring_[index];
  CountOutside(block.begin);  // the gap before this block may have ended the stroke
  if (!in_stroke_) {
    in_stroke_ = true;
    summary_ = StrokeSummary{};
    summary_.begin = block.begin;
    conditions_.Begin();
    stroke_blocks_ = 0;
  }
  last_gated_ = block.begin + window_.block * window_.period;
  closed_for_ = 0;
  if (stretch_blocks_ == 0) stretch_begin_ = block.begin;
  const int m = window_.block;
  if (stretch_.samples == 0) {
    const int blocks = std::min(index, kBeyond);
    stretch_.before = blocks * m;
    CopyBlocks(index - blocks, blocks, -stretch_.before);
  }
  CopyBlocks(index, 1, stretch_.samples);
  next_block_ = index + 1;
  stretch_.samples += m;
  since_stroke_.gated += m;

  conditions_.Add(block.sample, m);
  stroke_blocks_ += 1;
  if (++stretch_blocks_ == window_.span) Emit();
}

void StrokeSegmenter::Emit() {
  since_stroke_.used += static_cast<std::int64_t>(stretch_blocks_) * window_.block;
  const int blocks_after = std::clamp(pending_ - next_block_, 0, kBeyond);
  CopyBlocks(next_block_, blocks_after, stretch_.samples);
  stretch_.after = blocks_after * window_.block;
  if (!first_begin_) first_begin_ = stretch_begin_;
  stretch_.begin = stretch_begin_ - *first_begin_ - (stretch_.continues ? window_.period : 0.0);
  sink_.on_stretch(stretch_, stretch_begin_);
  // The next one begins with the last sample of this one.
  const int last = stretch_.before + stretch_.samples - 1;
  stretch_.before = std::min(last, kBeyond * window_.block);
  for (std::size_t c = 0; c < model_->channel_source.size(); ++c) {
    std::vector<double>& x = stretch_.channel[c];
    std::copy_n(x.begin() + (last - stretch_.before), stretch_.before + 1, x.begin());
  }
  stretch_.continues = true;
  stretch_.samples = 1;
  stretch_blocks_ = 0;
}

void StrokeSegmenter::EndSegment() {
  if (stretch_blocks_ >= window_.min_span) Emit();
  stretch_.continues = false;
  stretch_.samples = stretch_.before = stretch_.after = 0;
  stretch_blocks_ = 0;
  conditions_.Break();
}

void StrokeSegmenter::CountOutside(double time) {
  closed_for_ = time - last_gated_;
  if (in_stroke_ && (time - last_gated_ > gate_.stroke_gap || time < last_gated_ - gate_.stroke_gap))
    EndStroke();
}

void StrokeSegmenter::EndStroke() {
  EndSegment();
  in_stroke_ = false;
  const double gated_time = stroke_blocks_ * window_.block * window_.period;
  if (gated_time < gate_.min_stroke) {
    since_stroke_.used = 0;
    ++discarded_;
    sink_.on_discard();
    return;
  }
  summary_.index = next_index_++;
  summary_.end = last_gated_;
  summary_.counters = since_stroke_;
  conditions_.Write(gated_time, summary_);
  AddToTotals();
  sink_.on_stroke(summary_);
}

void StrokeSegmenter::AddToTotals() {
  totals_.samples += since_stroke_.samples;
  totals_.gated += since_stroke_.gated;
  totals_.used += since_stroke_.used;
  for (std::size_t f = 0; f < totals_.flagged.size(); ++f) totals_.flagged[f] += since_stroke_.flagged[f];
  since_stroke_ = StrokeCounters{};
}

void StrokeSegmenter::Finish() {
  Break();
  if (in_stroke_) EndStroke();
  AddToTotals();
}

}  // namespace hydroscope
