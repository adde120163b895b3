#include "acquisition/standstill.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace hydroscope {
namespace {

constexpr double kPieceTime = 0.02;  // s
constexpr int kFewestRows = 4;       // in a piece
/// Range of the means over their standard deviation that noise explains: of 10 000 means, 8 is reached in one
/// of 100 such runs.
constexpr double kRangeOfNoise = 8.0;
// The noise is that of the quieter pieces: steps between rows hold the motion as well.
constexpr double kNoiseFalls = 0.2, kNoiseRises = 1.02;  // share of a quieter piece; factor at most per piece
constexpr double kCommandMoves = 1.0;  // V, a tenth of full command
constexpr double kFullyOpen = 0.97;    // of the spool: it may rest at its stop
constexpr double kOpen = 0.05;         // of the spool, either way: beyond any overlap
constexpr double kGoes = 0.01;         // m/s
constexpr int kPiecesToProve = 4;      // of each kind of movement

}  // namespace

std::optional<Standstill> Standstill::For(const Machine& machine, double sample_period) {
  if (machine.model != "die_cushion" || !(sample_period > 0) || sample_period > kPieceTime / 2)
    return std::nullopt;
  const int rows = std::max(kFewestRows, static_cast<int>(std::lround(kPieceTime / sample_period)));
  Standstill out(rows);
  out.piece_time_ = rows * sample_period;
  constexpr std::array<const char*, kSignals> kNames = {"y_v", "U_v", "p_A", "z"};
  for (int s = 0; s < kSignals; ++s) out.channel_[s] = machine.SignalIndex(kNames[s]);
  for (const Signal needed : {kSpool, kPressure, kPosition})
    if (out.channel_[needed] < 0) return std::nullopt;
  for (Piece& piece : out.piece_) piece.last = kNaN;
  out.commands_.fill(kNaN);
  return out;
}

void Standstill::Judge(SampleBlock& block, const FlagBack& back) {
  const std::size_t rows = block.rows();
  for (std::size_t row = 0; row < rows;) {
    const std::size_t count = std::min<std::size_t>(rows - row, static_cast<std::size_t>(rows_ - filled_));
    for (int s = 0; s < kSignals; ++s) {
      if (channel_[s] < 0) continue;
      Piece& piece = piece_[s];
      const double* x = block.signal[static_cast<std::size_t>(channel_[s])].data() + row;
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
    row += count;
    filled_ += static_cast<int>(count);
    if (filled_ == rows_) EndPiece(block, row, back);
  }
}

/// A piece ended before `row` of the block.
void Standstill::EndPiece(SampleBlock& block, std::size_t row, const FlagBack& back) {
  filled_ = 0;
  for (Piece& piece : piece_) {
    piece.mean = piece.sum / rows_;
    const double variance = piece.steps / (2.0 * rows_);
    piece.whole = std::isfinite(piece.mean) && std::isfinite(variance);
    if (piece.whole)
      piece.noise = piece.noise < 0            ? variance
                    : variance < piece.noise ? piece.noise + kNoiseFalls * (variance - piece.noise)
                                             : std::min(variance, kNoiseRises * piece.noise);
    piece.sum = piece.steps = 0;
  }
  const bool spool_stood = spool_.stands, pressure_stood = pressure_.stands;
  JudgeSpool();
  JudgePressure();
  Flag(kSpool, spool_, spool_stood, block, row, back);
  Flag(kPressure, pressure_, pressure_stood, block, row, back);
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

void Standstill::JudgeSpool() {
  if (channel_[kCommand] < 0) return;
  const bool stays = Extend(piece_[kSpool], spool_);
  const double command = commands_.front();  // the spool had time to follow it
  if (!stays) {
    command_low_ = command_high_ = command;
  } else if (std::isfinite(command)) {
    command_low_ = std::isfinite(command_low_) ? std::min(command_low_, command) : command;
    command_high_ = std::isfinite(command_high_) ? std::max(command_high_, command) : command;
  }
  std::rotate(commands_.begin(), commands_.begin() + 1, commands_.end());
  commands_.back() = piece_[kCommand].whole ? piece_[kCommand].mean : kNaN;
  const bool at_stop = std::abs(piece_[kSpool].mean) >= kFullyOpen;
  if (stays && !at_stop && command_high_ - command_low_ >= kCommandMoves) spool_.stands = true;
}

void Standstill::JudgePressure() {
  const Piece &spool = piece_[kSpool], &position = piece_[kPosition];
  if (!Extend(piece_[kPressure], pressure_)) opening_ = closing_ = down_ = up_ = 0;
  opening_ += spool.whole && spool.mean > kOpen;
  closing_ += spool.whole && spool.mean < -kOpen;
  const double speed = (position.mean - position_before_) / piece_time_;
  down_ += speed < -kGoes;
  up_ += speed > kGoes;
  position_before_ = position.mean;
  if (std::min({opening_, closing_, down_, up_}) >= kPiecesToProve) pressure_.stands = true;
}

void Standstill::Flag(Signal signal, Run& run, bool stood, SampleBlock& block, std::size_t row,
                      const FlagBack& back) const {
  if (!run.stands) return;
  const auto channel = static_cast<std::size_t>(channel_[signal]);
  const auto rows = static_cast<std::size_t>(stood ? rows_ : run.rows);
  const std::size_t here = std::min(rows, row);
  for (std::size_t k = row - here; k < row; ++k) block.quality[channel][k] |= quality::kStuck;
  if (rows > here) back(channel, rows - here);
}

}  // namespace hydroscope
