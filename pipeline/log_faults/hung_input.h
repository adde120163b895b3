#pragma once

#include <span>
#include <vector>

#include "core/records/sample_block.h"
#include "core/told.h"
#include "models/machine.h"
#include "pipeline/log_faults/frozen_pressure.h"

namespace hydroscope {

/// When a repeated reading of an input is no rest of a command but a hung sensor, wire or logger.
struct HungInputOptions {
  int rows_before = 200;  ///< that tell whether noise scatters the readings
  int least_before = 30;  ///< of them, without which nothing is concluded
  /// Correlation of third differences with the next ones, below which they are noise: -3/4 of white noise, 1 of smooth motion.
  double of_noise = -0.4;
  /// Share of these rows that repeat a reading: a coarse converter does, and may rest under its noise.
  double repeats = 0.1;
  /// Of an output's range over the log, that it covers in the second half of the rest: where the input is held, a machine settles.
  double moves = 0.3;
  int smooth = 5;  ///< rows of the means that a range is taken of
};

/// Stretches in which one of `inputs` repeats a reading bit for bit for its `stuck_time` and longer (QualityMonitor: kStuck), after
/// noise that would scatter it at rest as well, while an output goes on moving: it was measured, and hung. A command that rests
/// comes to it without noise. Not of signals with stuck_time = 0.
std::vector<FrozenStretch> HungInputs(const Machine& machine, std::span<const int> inputs,
                                      std::span<const int> outputs, const SampleBlock& rows,
                                      const HungInputOptions& options = {});

/// Takes the readings out of them that hung: missing and stuck.
void LeaveOutHung(std::span<const FrozenStretch> hung, SampleBlock& block);

/// A sentence for each such signal.
std::vector<Told> HungTexts(std::span<const FrozenStretch> hung, const Machine& machine);

/// That none of `inputs` moves in a log, with two readings and more, while an output goes on moving through its second half: a command
/// may be held, but one that is not connected looks the same. A sentence; "" otherwise.
Told NoInputMoves(const Machine& machine, std::span<const int> inputs, std::span<const int> outputs,
                  const SampleBlock& rows, const HungInputOptions& options = {});

}  // namespace hydroscope
