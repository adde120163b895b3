#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/sample_block.h"
#include "models/machine.h"

namespace hydroscope {

/// Finds signals of a die cushion that stand still, bit for bit or but for their noise, while what drives
/// them moves:
///
///   y_v  while the command U_v moves by 1 V and more, and had time to act on the spool;
///   p_A  while the spool opens both ways and the cushion goes down and up: oil leaves the chamber and enters
///   it.
///
/// Works on means of pieces of 20 ms: a signal stands as long as all of them lie within what white noise of
/// its size (from the steps between rows) explains. From the first proof on its values are flagged
/// quality::kStuck until it moves again. Neither allocates per row nor depends on how rows are cut into blocks.
class Standstill {
 public:
  /// Nothing if the machine has no pair of signals to judge. `sample_period` in s.
  static std::optional<Standstill> For(const Machine& machine, double sample_period);

  /// Adds flags to the rows of `block`, the rows that came next.
  void Judge(SampleBlock& block);

 private:
  static constexpr int kSignals = 4;  ///< y_v, U_v, p_A, z
  enum Signal { kSpool, kCommand, kPressure, kPosition };
  static constexpr int kLag = 3;  ///< pieces that a valve may take to follow its command

  /// What is known of one signal over the piece under way, and its noise.
  struct Piece {
    double sum = 0, steps = 0;  ///< of values; of squared steps between rows
    double last = 0;            ///< value of the row before
    bool whole = true;          ///< no value missing
    double mean = 0;            ///< of the piece that ended
    double noise = -1;          ///< variance of one reading; -1 until known
  };
  /// A signal since it last moved.
  struct Run {
    std::int64_t rows = 0;
    double low = 0, high = 0;  ///< of piece means
    bool stands = false;       ///< proven
  };

  explicit Standstill(int rows) : rows_(rows) {}
  void EndPiece();
  bool Extend(const Piece& piece, Run& run) const;
  void JudgeSpool();
  void JudgePressure();
  void Flag(Signal signal, const Run& run, std::size_t begin, std::size_t end, SampleBlock& block) const;

  int rows_;  ///< in a piece
  int filled_ = 0;
  double piece_time_ = 0;                ///< s
  std::array<int, kSignals> channel_{};  ///< -1: not there
  std::array<Piece, kSignals> piece_;
  Run spool_, pressure_;
  std::array<double, kLag> commands_{};  ///< of the last pieces, oldest first
  double command_low_ = 0, command_high_ = 0;
  int opening_ = 0, closing_ = 0, down_ = 0, up_ = 0;  ///< pieces since p_A last moved
  double position_before_ = 0;
};

}  // namespace hydroscope
