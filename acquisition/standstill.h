#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/records/sample_block.h"
#include "models/machine.h"
#include "models/standstill_rule.h"

namespace hydroscope {

/// Finds signals that stand still, bit for bit or but for their noise, while what drives them moves, as the machine's kind
/// says (MachineKind::standstill): while their command moves by a tenth of its range and they had time to act on it, or
/// while each of the movements that drive them takes place again and again.
///
/// Works on means of pieces of 20 ms: a signal stands as long as all of them lie within what white noise of
/// its size (from the steps between rows) explains. From the first proof on its values are flagged
/// quality::kStuck until it moves again. Neither allocates per row nor depends on how rows are cut into blocks.
class Standstill {
 public:
  /// Nothing if the machine has no signal to judge. `sample_period` in s.
  static std::optional<Standstill> For(const Machine& machine, double sample_period);

  /// Adds flags to the rows of `block`, the rows that came next.
  void Judge(SampleBlock& block);

 private:
  static constexpr int kLag = 3;  ///< pieces that a signal may take to follow its command

  /// What is known of one signal over the piece under way, and its noise.
  struct Piece {
    std::size_t signal = 0;       ///< of the machine
    double sum = 0, steps = 0;    ///< of values; of squared steps between rows
    double last = 0;              ///< value of the row before
    bool whole = true;            ///< no value missing
    double mean = 0, before = 0;  ///< of the piece that ended, of the one before it
    double noise = -1;            ///< variance of one reading; -1 until known
  };
  /// A signal since it last moved.
  struct Run {
    std::int64_t rows = 0;
    double low = 0, high = 0;  ///< of piece means
    bool stands = false;       ///< proven
  };
  struct Movement {
    std::size_t piece = 0;
    GateBound bound;
    int pieces = 0;  ///< in which it took place since the signal last moved
  };
  /// A rule with what was seen of it.
  struct Watch {
    std::size_t piece = 0;
    Run run;
    std::optional<std::size_t> command;  ///< piece
    double full_command = 1, at_stop = 0;
    std::array<double, kLag> commands{};  ///< of the last pieces, oldest first
    double command_low = 0, command_high = 0;
    std::vector<Movement> movements;
  };

  explicit Standstill(int rows) : rows_(rows) {}
  std::optional<std::size_t> AddPiece(const Machine& machine, const std::string& signal);
  void Add(const Machine& machine, const StandstillRule& rule);
  void EndPiece();
  bool Extend(const Piece& piece, Run& run) const;
  void JudgeCommand(Watch& watch, bool stays) const;
  void JudgeMovements(Watch& watch, bool stays) const;
  void Flag(const Watch& watch, std::size_t begin, std::size_t end, SampleBlock& block) const;

  int rows_;  ///< in a piece
  int filled_ = 0;
  double piece_time_ = 0;  ///< s
  std::vector<Piece> pieces_;
  std::vector<Watch> watches_;
};

}  // namespace hydroscope
