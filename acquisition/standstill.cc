#include "acquisition/standstill.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

constexpr double kPieceTime = 0.02;  // s
constexpr int kFewestRows = 4;       // in a piece
/// Range of the means over their standard deviation that noise explains: of 10 000 means, 8 is reached in one
/// of 100 such runs.
constexpr double kRangeOfNoise = 8.0;
// The noise is that of the quieter pieces: steps between rows hold the motion as well.
constexpr double kNoiseFalls = 0.2, kNoiseRises = 1.02;  // share of a quieter piece; factor at most per piece
constexpr double kCommandMoves = 0.1;                    // of full command
constexpr double kIgnores = 0.1;                         // share of the movement it is told to make
constexpr int kPiecesToProve = 4;                        // of each kind of movement
// Of full command: data sheets of valves state hysteresis and threshold of some tenths of a per cent.
constexpr double kHysteresis = 0.01;
constexpr double kResolutions = 2.0;  // that the command moves by, at least
// A run of equal readings that is so many times as long as they are while the command moves, of so many changes at least.
constexpr double kRunsOfEquals = 25.0, kMovingChanges = 100.0;

}  // namespace

std::optional<Standstill> Standstill::For(const Machine& machine, double sample_period) {
  if (!(sample_period > 0) || sample_period > kPieceTime / 2) return std::nullopt;
  const int rows = std::max(kFewestRows, static_cast<int>(std::lround(kPieceTime / sample_period)));
  Standstill out(rows);
  out.piece_time_ = rows * sample_period;
  for (const StandstillRule& rule : KindOf(machine).standstill) out.Add(machine, rule);
  return out.watches_.empty() ? std::nullopt : std::optional(std::move(out));
}

/// The piece of a signal; nothing if the machine does not measure it.
std::optional<std::size_t> Standstill::AddPiece(const Machine& machine, const std::string& signal) {
  const int index = machine.SignalIndex(signal);
  if (index < 0) return std::nullopt;
  for (std::size_t p = 0; p < pieces_.size(); ++p)
    if (pieces_[p].signal == static_cast<std::size_t>(index)) return p;
  Piece piece;
  piece.signal = static_cast<std::size_t>(index);
  piece.last = kNaN;
  pieces_.push_back(piece);
  return pieces_.size() - 1;
}

/// Nothing to judge if the machine does not measure all that the rule needs.
void Standstill::Add(const Machine& machine, const StandstillRule& rule) {
  Watch watch;
  const auto piece = AddPiece(machine, rule.signal);
  if (!piece) return;
  watch.piece = *piece;
  if (!rule.command.empty()) {
    watch.command = AddPiece(machine, rule.command);
    if (!watch.command) return;
  }
  for (const GateBound& bound : rule.movements) {
    const auto moved = AddPiece(machine, bound.signal);
    if (!moved) return;
    watch.movements.push_back({*moved, bound});
  }
  watch.judges_same = watch.command && machine.signals[pieces_[watch.piece].signal].stuck_time > 0;
  watch.full_command = rule.full_command;
  watch.at_stop = rule.at_stop;
  watch.commands.fill(kNaN);
  watches_.push_back(std::move(watch));
}

std::size_t Standstill::Reach(std::size_t signal) const {
  for (const Watch& watch : watches_)
    if (watch.judges_same && pieces_[watch.piece].signal == signal)
      return std::min(kMostRows, static_cast<std::size_t>(std::lround(kReach * rows_ / piece_time_)));
  return 0;
}

void Standstill::Judge(SampleBlock& block) {
  const std::size_t rows = block.rows();
  before_.clear();
  for (std::size_t row = 0; row < rows;) {
    const std::size_t count = std::min<std::size_t>(rows - row, static_cast<std::size_t>(rows_ - filled_));
    for (Watch& watch : watches_)
      if (watch.judges_same) Follow(row, row + count, watch, block);
    for (Piece& piece : pieces_) {
      const double* x = block.signal[piece.signal].data() + row;
      double sum = 0, steps = 0, last = piece.last;
      for (std::size_t i = 0; i < count; ++i) {
        const double step = x[i] - last;
        sum += x[i];
        steps += step * step;
        last = x[i];
      }
      piece.last = last;
      piece.sum += sum;
      piece.steps += steps;
    }
    for (const Watch& watch : watches_) Flag(watch, row, row + count, block);
    row += count;
    filled_ += static_cast<int>(count);
    if (filled_ == rows_) EndPiece(row, block);
  }
}

/// Counts equal readings, and flags those of a run that is known to be stuck.
void Standstill::Follow(std::size_t begin, std::size_t end, Watch& watch, SampleBlock& block) const {
  const Piece& piece = pieces_[watch.piece];
  Same& same = watch.same;
  double last = piece.last;
  for (std::size_t row = begin; row < end; ++row) {
    const double step = std::abs(block.signal[piece.signal][row] - last);
    last = block.signal[piece.signal][row];
    if (step == 0) {
      ++same.rows;
      if (same.proven) block.quality[piece.signal][row] |= quality::kStuck;
      continue;
    }
    if (same.proven) watch.run = {};
    same.rows = 1;
    same.proven = false;
    if (!(step > 0)) continue;
    ++same.changes;
    if (same.resolution == 0 || step < same.resolution) same.resolution = step;
  }
}

/// `rows` of the block have been seen.
void Standstill::EndPiece(std::size_t rows, SampleBlock& block) {
  filled_ = 0;
  for (Piece& piece : pieces_) {
    piece.before = piece.mean;
    piece.mean = piece.sum / rows_;
    const double variance = piece.steps / (2.0 * rows_);
    piece.whole = std::isfinite(piece.mean) && std::isfinite(variance);
    if (piece.whole)
      piece.noise = piece.noise < 0          ? variance
                    : variance < piece.noise ? piece.noise + kNoiseFalls * (variance - piece.noise)
                                             : std::min(variance, kNoiseRises * piece.noise);
    piece.sum = piece.steps = 0;
  }
  for (Watch& watch : watches_) {
    if (watch.judges_same) JudgeSame(rows, watch, block);
    const bool stays = Extend(pieces_[watch.piece], watch.run);
    if (watch.command) JudgeCommand(watch, stays);
    if (!watch.movements.empty()) JudgeMovements(watch, stays);
  }
}

/// False if the signal moved: a new run begins with this piece.
bool Standstill::Extend(const Piece& piece, Run& run) const {
  const double limit = kRangeOfNoise * std::sqrt(std::max(0.0, piece.noise) / rows_);
  const double low = std::min(run.low, piece.mean), high = std::max(run.high, piece.mean);
  const bool goes_on = run.rows > 0 && piece.whole && high - low <= limit;
  if (goes_on) {
    run.low = low;
    run.high = high;
    run.rows += rows_;
  } else {
    run = {piece.whole ? rows_ : 0, piece.mean, piece.mean, false};
  }
  return goes_on;
}

void Standstill::JudgeCommand(Watch& watch, bool stays) const {
  const double command = watch.commands.front();  // the signal had time to follow it
  // Commands from before it stood say nothing: it followed them.
  if (!stays || watch.run.rows <= (kLag + 1) * rows_) {
    watch.command_low = watch.command_high = kNaN;
  } else if (std::isfinite(command)) {
    watch.command_low = std::isfinite(watch.command_low) ? std::min(watch.command_low, command) : command;
    watch.command_high = std::isfinite(watch.command_high) ? std::max(watch.command_high, command) : command;
  }
  std::rotate(watch.commands.begin(), watch.commands.begin() + 1, watch.commands.end());
  const Piece& now = pieces_[*watch.command];
  watch.commands.back() = now.whole ? now.mean : kNaN;
  const bool at_stop = watch.at_stop > 0 && std::abs(pieces_[watch.piece].mean) >= watch.at_stop;
  // Beside a noise that is overrated after fast motion: it moves by a small share of what it is told to.
  const double told = (watch.command_high - watch.command_low) / watch.full_command;
  const bool ignores = watch.run.high - watch.run.low < kIgnores * told;
  if (stays && !at_stop && ignores && told >= kCommandMoves) watch.run.stands = true;
}

/// Commands count from when the readings are equal, and as late as the signal had time to follow.
void Standstill::JudgeSame(std::size_t rows, Watch& watch, SampleBlock& block) {
  Same& same = watch.same;
  const Piece& command = pieces_[*watch.command];
  const double moved = std::abs(command.mean - command.before) / watch.full_command;
  if (command.whole && moved > kHysteresis / 10 && !same.proven) {
    same.moving_rows += rows_;
    same.moving_changes += static_cast<double>(same.changes);
  }
  same.changes = 0;
  const double followed = watch.commands.front();
  if (same.rows <= static_cast<std::size_t>((kLag + 1) * rows_)) {
    same.command_low = same.command_high = kNaN;
    return;
  }
  if (std::isfinite(followed)) {
    same.command_low = std::fmin(same.command_low, followed);
    same.command_high = std::fmax(same.command_high, followed);
  }
  const bool at_stop = watch.at_stop > 0 && std::abs(pieces_[watch.piece].last) >= watch.at_stop;
  if (same.proven || at_stop || same.moving_changes < kMovingChanges) return;
  const double longest = kRunsOfEquals * same.moving_rows / same.moving_changes;
  const double noise = kRangeOfNoise * std::sqrt(std::max(0.0, command.noise) / rows_);
  const double told = (same.command_high - same.command_low - noise) / watch.full_command;
  if (static_cast<double>(same.rows) <= longest ||
      !(told > std::max(kHysteresis, kResolutions * same.resolution)))
    return;
  same.proven = true;
  const std::size_t signal = pieces_[watch.piece].signal, back = std::min(same.rows, Reach(signal));
  for (std::size_t k = 1; k <= std::min(back, rows); ++k) block.quality[signal][rows - k] |= quality::kStuck;
  if (back > rows) before_.push_back({signal, back - rows});
}

void Standstill::JudgeMovements(Watch& watch, bool stays) const {
  bool all = true;
  for (Movement& movement : watch.movements) {
    if (!stays) movement.pieces = 0;
    const Piece& piece = pieces_[movement.piece];
    const double x = movement.bound.rate ? (piece.mean - piece.before) / piece_time_ : piece.mean;
    movement.pieces += piece.whole && x >= movement.bound.min.value_or(-INFINITY) &&
                       x <= movement.bound.max.value_or(INFINITY);
    all = all && movement.pieces >= kPiecesToProve;
  }
  if (all) watch.run.stands = true;
}

void Standstill::Flag(const Watch& watch, std::size_t begin, std::size_t end, SampleBlock& block) const {
  if (!watch.run.stands) return;
  std::vector<Quality>& quality = block.quality[pieces_[watch.piece].signal];
  for (std::size_t k = begin; k < end; ++k) quality[k] |= quality::kStuck;
}

}  // namespace hydroscope
