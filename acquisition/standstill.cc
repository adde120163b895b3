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
constexpr double kFullCommand = 10.0;                    // V
constexpr double kCommandMoves = 0.1;                    // of full command
constexpr double kIgnores = 0.1;                         // share of the movement it is told to make
constexpr double kFullyOpen = 0.97;                      // of the spool: it may rest at its stop
constexpr double kOpen = 0.05;                           // of the spool, either way: beyond any overlap
constexpr double kGoes = 0.01;                           // m/s
constexpr int kPiecesToProve = 4;                        // of each kind of movement

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

void Standstill::Judge(SampleBlock& block) {
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
    Flag(kSpool, spool_, row, row + count, block);
    Flag(kPressure, pressure_, row, row + count, block);
    row += count;
    filled_ += static_cast<int>(count);
    if (filled_ == rows_) EndPiece();
  }
}

void Standstill::EndPiece() {
  filled_ = 0;
  for (Piece& piece : piece_) {
    piece.mean = piece.sum / rows_;
    const double variance = piece.steps / (2.0 * rows_);
    piece.whole = std::isfinite(piece.mean) && std::isfinite(variance);
    if (piece.whole)
      piece.noise = piece.noise < 0          ? variance
                    : variance < piece.noise ? piece.noise + kNoiseFalls * (variance - piece.noise)
                                             : std::min(variance, kNoiseRises * piece.noise);
    piece.sum = piece.steps = 0;
  }
  JudgeSpool();
  JudgePressure();
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
  // Commands from before it stood say nothing: it followed them.
  if (!stays || spool_.rows <= (kLag + 1) * rows_) {
    command_low_ = command_high_ = kNaN;
  } else if (std::isfinite(command)) {
    command_low_ = std::isfinite(command_low_) ? std::min(command_low_, command) : command;
    command_high_ = std::isfinite(command_high_) ? std::max(command_high_, command) : command;
  }
  std::rotate(commands_.begin(), commands_.begin() + 1, commands_.end());
  commands_.back() = piece_[kCommand].whole ? piece_[kCommand].mean : kNaN;
  const bool at_stop = std::abs(piece_[kSpool].mean) >= kFullyOpen;
  // Beside a noise that is overrated after fast motion: it moves by a small share of what it is told to.
  const double told = (command_high_ - command_low_) / kFullCommand;
  const bool ignores = spool_.high - spool_.low < kIgnores * told;
  if (stays && !at_stop && ignores && told >= kCommandMoves) spool_.stands = true;
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

void Standstill::Flag(Signal signal, const Run& run, std::size_t begin, std::size_t end,
                      SampleBlock& block) const {
  if (!run.stands) return;
  std::vector<Quality>& quality = block.quality[static_cast<std::size_t>(channel_[signal])];
  for (std::size_t k = begin; k < end; ++k) quality[k] |= quality::kStuck;
}

}  // namespace hydroscope
