#include "pipeline/log_faults/frozen_pressure.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pipeline/log_faults/pressures_in_motion.h"

namespace hydroscope {
namespace {

/// Times its mean step, beside noise, by which a position that moves on evenly may go on within a row.
constexpr double kOnEvenly = 5;

double MeanOf(const double* first, std::size_t count) {
  return std::accumulate(first, first + count, 0.0) / static_cast<double>(count);
}

}  // namespace

FrozenPressures::FrozenPressures(const Machine& machine, const FrozenPressureOptions& options)
    : options_(options) {
  const PressuresInMotion in_motion = PressuresInMotionOf(machine);
  position_ = in_motion.position;
  for (const std::size_t s : in_motion.pressures) tracks_.push_back({s, {}});
}

void FrozenPressures::Observe(const SampleBlock& block, const std::vector<ChannelQuality>& channels) {
  if (tracks_.empty() || block.rows() == 0) return;
  Forget();
  const std::size_t before = times_.size();
  times_.insert(times_.end(), block.time.begin(), block.time.end());
  const std::vector<double>& z = block.signal[position_];
  positions_.insert(positions_.end(), z.begin(), z.end());
  for (Track& track : tracks_) {
    const std::vector<double>& p = block.signal[track.signal];
    track.readings.insert(track.readings.end(), p.begin(), p.end());
    // Rows with as many behind them as it takes, from where the block before left off.
    const std::size_t first = std::max(before, 2 * kBeside) - kBeside;
    for (std::size_t row = first; row + kBeside <= times_.size(); ++row) Look(track, row, channels);
  }
}

/// Keeps the last rows.
void FrozenPressures::Forget() {
  if (times_.size() < 2 * kKept) return;
  const auto drop = static_cast<std::ptrdiff_t>(times_.size() - kKept);
  times_.erase(times_.begin(), times_.begin() + drop);
  positions_.erase(positions_.begin(), positions_.begin() + drop);
  for (Track& track : tracks_) track.readings.erase(track.readings.begin(), track.readings.begin() + drop);
}

/// Whether a step that is sharp on both sides leads to `row`.
bool FrozenPressures::Jumps(const Track& track, std::size_t row, double noise) const {
  const double* const p = track.readings.data() + row;
  const double at_once = std::abs(p[0] - p[-1]);
  if (!(at_once >= options_.at_once * options_.step * noise)) return false;
  const double step = std::abs(MeanOf(p, kBeside) - MeanOf(p - kBeside, kBeside));
  if (!(step >= options_.step * noise) || at_once < options_.at_once * step) return false;
  const double behind = std::abs(p[3] + p[4] - p[0] - p[1]) / 2,
               ahead = std::abs(p[-1] + p[-2] - p[-4] - p[-5]) / 2;
  return behind <= std::max(options_.still * noise, options_.on * step) && ahead <= options_.still * noise;
}

/// Of those before `row`.
std::size_t FrozenPressures::RowsOfOneLevel(const Track& track, std::size_t row, double noise) const {
  double sum = 0;
  std::size_t pieces = 0;
  for (; kPiece * (pieces + 1) <= row; ++pieces) {
    const double mean = MeanOf(track.readings.data() + row - kPiece * (pieces + 1), kPiece);
    const auto n = static_cast<double>(pieces);
    const double std = noise / std::sqrt(static_cast<double>(kPiece)) * std::sqrt(1 + 1 / std::max(1.0, n));
    if (!std::isfinite(mean) || (pieces > 0 && std::abs(mean - sum / n) > options_.level * std)) break;
    sum += mean;
  }
  return kPiece * pieces;
}

void FrozenPressures::Look(const Track& track, std::size_t row, const std::vector<ChannelQuality>& channels) {
  const double noise = channels[track.signal].noise_std;
  if (!(noise > 0) || !Jumps(track, row, noise)) return;
  const std::size_t rows = RowsOfOneLevel(track, row, noise);
  if (rows < static_cast<std::size_t>(options_.least)) return;
  // The position moves, and moves on: where it jumps as well, something else was recorded from there on.
  const double moved = std::abs(positions_[row - 1] - positions_[row - rows]),
               moves = options_.moves * channels[position_].noise_std,
               each_row = moved / static_cast<double>(rows);
  if (!(moved > moves) || std::abs(positions_[row] - positions_[row - 1]) > moves + kOnEvenly * each_row)
    return;
  found_.push_back({track.signal, times_[row - rows], times_[row - 1]});
}

void FlagFrozen(std::span<const FrozenStretch> frozen, SampleBlock& block) {
  for (const FrozenStretch& stretch : frozen)
    for (std::size_t row = 0; row < block.rows(); ++row)
      if (block.time[row] >= stretch.begin && block.time[row] <= stretch.end)
        block.quality[stretch.signal][row] |= quality::kStuck;
}

std::vector<Told> FrozenTexts(std::span<const FrozenStretch> frozen, const Machine& machine) {
  std::vector<Told> texts;
  for (std::size_t s = 0; s < machine.signals.size(); ++s) {
    const auto is_its = [s](const FrozenStretch& stretch) { return stretch.signal == s; };
    const auto first = std::ranges::find_if(frozen, is_its);
    if (first == frozen.end()) continue;
    const auto more = std::ranges::count_if(frozen, is_its) - 1;
    texts.push_back(Tell(
        "{} (column {}) stands still under its noise from {:.2f} to {:.2f} s while the machine moves, and then jumps{}: its sensor, or "
        "what reads it, hung. These readings are left out",
        "{} (Spalte {}) steht von {:.2f} bis {:.2f} s unter seinem Rauschen still, während die Maschine sich bewegt, und springt "
        "dann{}: sein Sensor, oder was ihn liest, hing. Diese Messwerte bleiben weg",
        machine.signals[s].name, machine.signals[s].column, first->begin, first->end,
        more > 0 ? Tell(", and {} times more", ", und noch {}-mal", more) : Told()));
  }
  return texts;
}

}  // namespace hydroscope
