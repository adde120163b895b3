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
///
/// One that repeats its reading bit for bit far longer than it does while its command moves needs less of a proof: that its
/// command moves by more than its resolution and the hysteresis of a valve. All of its equal readings are flagged then, as far
/// back as `kReach`.
class Standstill {
 public:
  /// Nothing if the machine has no signal to judge. `sample_period` in s.
  static std::optional<Standstill> For(const Machine& machine, double sample_period);

  /// Rows before the block judged last that turned out to be stuck.
  struct Before {
    std::size_t signal = 0;  ///< of the machine
    std::size_t rows = 0;
  };

  /// Adds flags to the rows of `block`, the rows that came next.
  void Judge(SampleBlock& block);
  const std::vector<Before>& before() const { return before_; }
  /// Rows of one reading that may turn out to be stuck, of a signal of the machine; 0: none is looked for.
  std::size_t Reach(std::size_t signal) const;

 private:
  static constexpr double kReach = 0.5;           ///< s, ...
  static constexpr std::size_t kMostRows = 1000;  ///< ... and no more rows
  static constexpr int kLag = 3;                  ///< pieces that a signal may take to follow its command

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
  /// Rows of the very same reading, up to the last one.
  struct Same {
    std::size_t rows = 0;
    bool proven = false;                         ///< stuck
    double command_low = 0, command_high = 0;    ///< since it stands
    double resolution = 0;                       ///< least step between readings seen; 0: none yet
    std::int64_t changes = 0;                    ///< of reading in the piece under way
    double moving_rows = 0, moving_changes = 0;  ///< while the command moved
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
    Same same;
    std::optional<std::size_t> command;  ///< piece
    bool judges_same = false;            ///< it follows a command, and its machine file lets it be stuck
    double full_command = 1, at_stop = 0;
    std::array<double, kLag> commands{};  ///< of the last pieces, oldest first
    double command_low = 0, command_high = 0;
    std::vector<Movement> movements;
  };

  explicit Standstill(int rows) : rows_(rows) {}
  std::optional<std::size_t> AddPiece(const Machine& machine, const std::string& signal);
  void Add(const Machine& machine, const StandstillRule& rule);
  void EndPiece(std::size_t rows, SampleBlock& block);
  void Follow(std::size_t begin, std::size_t end, Watch& watch, SampleBlock& block) const;
  void JudgeSame(std::size_t rows, Watch& watch, SampleBlock& block);
  bool Extend(const Piece& piece, Run& run) const;
  void JudgeCommand(Watch& watch, bool stays) const;
  void JudgeMovements(Watch& watch, bool stays) const;
  void Flag(const Watch& watch, std::size_t begin, std::size_t end, SampleBlock& block) const;

  int rows_;  ///< in a piece
  int filled_ = 0;
  double piece_time_ = 0;  ///< s
  std::vector<Piece> pieces_;
  std::vector<Watch> watches_;
  std::vector<Before> before_;
};

}  // namespace hydroscope
