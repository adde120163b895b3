#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/records/sample_block.h"
#include "core/told.h"
#include "models/machine.h"
#include "models/standstill_rule.h"

namespace hydroscope {

/// What makes the answer to a command doubtful. The limits lie between what valves do and what a wrong sign or a factor of 2 makes.
struct CommandAnswerOptions {
  std::int64_t least_rows = 1000;  ///< that both are good in
  /// Standard deviation of the command or the signal over its full range, below which both move too little to tell.
  double least_motion = 0.02;
  /// Correlation, below the negative of which the two go against each other; noise, a delay or rests take it to 0 at most.
  double against = 0.5;
  /// Correlation from which on their ranges are compared.
  double together = 0.9;
  /// Gain between the two beside the one of data sheets, either way: edges with a knee, a compensated overlap and the setting of an
  /// amplifier stay well within, ends of another range (5 V, 20 mA over 500 ohm) and a factor of 2 do not.
  double most_gain = 1.5;
  /// Of where the signal ends: a sensor's gain reaches a tenth beyond, and `beyond_share` of the rows are no disturbance.
  double beyond_end = 1.2, beyond_share = 0.001;
  /// Share of the rows of a log within [gate], from which on there are strokes, and up to which there are as good as none.
  double strokes = 0.05, no_strokes = 0.01;
};

/// Looks in a log for signals that do not answer their command (MachineKind::standstill) as they must:
///   - one goes down as the other goes up: one of them counts the other way round;
///   - they move together, but one by far too little: unit or scale of one is wrong;
///   - the signal moves beyond where what it measures ends.
/// The command's full range is that of the rule, or the end of the range declared in the machine file where the two are at odds.
class CommandAnswers {
 public:
  /// `machine` must outlive it.
  explicit CommandAnswers(const Machine& machine, const CommandAnswerOptions& options = {});
  /// Rows with their flags set.
  void Observe(const SampleBlock& block);
  /// What is wrong with a signal of the machine.
  struct Fault {
    int signal = -1;
    Told text;
  };
  /// Signals that count the other way round than their command. `in_gate`: share of the rows of the log that [gate] lets through,
  /// where it is known, which tells which of the two it is.
  std::vector<Fault> Against(std::optional<double> in_gate = {}) const;
  /// Every other fault.
  std::vector<Fault> Sizes() const;

 private:
  struct Pair {
    const StandstillRule* rule = nullptr;
    int signal = -1, command = -1;  ///< -1: the machine has none
    double full = 1;                ///< SI of the command
    double last = 0, largest = 0;   ///< reading of the signal that is no spike, and the largest of these
    std::int64_t read = 0, beyond = 0;
    /// Sums over rows that both are good in, shares of full range.
    double rows = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
    double Correlation() const;
    double Gain() const;
    double Motion() const;  ///< of the one that moves more
  };
  bool Moves(const Pair& pair) const;
  Told NamesOf(const Pair& pair) const;
  Told LikelyText(const Pair& pair, std::optional<double> in_gate) const;
  Told BeyondText(const Pair& pair) const;
  Told GainText(const Pair& pair) const;

  const Machine& machine_;
  CommandAnswerOptions options_;
  std::vector<Pair> pairs_;
};

}  // namespace hydroscope
