#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/told.h"
#include "estimation/row_contrasts.h"

namespace hydroscope {

/// What a signal's noise is like, as far as rows next to one another tell.
enum class NoiseKind {
  kUnknown,           ///< too few rows, or none that differ
  kWhite,             ///< independent from row to row: what the noise share of the balance takes for granted
  kColoured,          ///< a sensor, amplifier or controller filters it: stronger over several rows, or weaker
  kQuantised,         ///< the resolution is coarser than the noise
  kSignalInContrast,  ///< the signal itself moves from row to row: sampled too slowly to see the noise
  kDisagreesWithStated,  ///< white, and clearly less than the machine file says
  kInterpolated,         ///< stored at some rows only, the others drawn straight between them
  kHeld,                 ///< stored at some rows only, the others repeat them
  kRepeats,              ///< it stands still in many rows and moves by many times its resolution: play, say
};

/// "white", "coloured", "quantised", "signal", "not as stated", "interpolated", "held", "repeating", "not known".
const char* NoiseKindName(NoiseKind kind);

/// Noise of one signal, by contrasts over single rows, pairs and fours of rows (RowContrasts).
struct SignalNoise {
  std::string name;  ///< of the signal
  std::string unit;  ///< SI
  NoiseKind kind = NoiseKind::kUnknown;
  double std = 0;        ///< SI, from + - - + over neighbouring rows, all rows: what the floor goes by
  double quiet_std = 0;  ///< SI, the same where the signal moves least
  /// What all rows have beyond the quiet ones: its energy over pairs of rows against single rows. White noise that comes in
  /// bursts about 1, motion alone 8 and more; NaN where there is no more.
  double loud_growth = std::numeric_limits<double>::quiet_NaN();
  bool seen_at_rest = true;  ///< the signal moves, but not always: `quiet_std` is that of its noise
  double ratio = 1;  ///< energy over pairs of rows against single rows where the signal moves least ...
  double ratio_low = 1, ratio_high = 1;  ///< ... and its 95 % band, by chunks of time
  double slow_ratio = 1;                 ///< the same over four rows; NaN where motion hides it
  double slope = 0;     ///< d ln energy / d ln d from one to two rows; white 0, first order up to 2, motion 5
  double range = 0;     ///< SI, from the 5 % to the 95 % quantile of the readings
  double quantum = 0;   ///< SI, smallest step between readings
  double repeated = 0;  ///< share of readings equal to the one before
  /// Share of readings that lie, to the resolution, midway between their neighbours while these differ.
  double straight = 0;
  double stated = std::numeric_limits<double>::quiet_NaN();  ///< SI, `noise` of the machine file
  double share = 1;  ///< of the noise energy of a balance; see JudgeFloor
  double unseen =
      1;  ///< energy that its noise has in a balance over what the balance's contrasts show of it; see JudgeFloor
  Told sentence;  ///< what is wrong with it, with units; "" if white
};

/// Thresholds of JudgeSignalNoise.
struct SignalNoiseOptions {
  /// Ratio that still counts as white. AR(1) noise of phi 0.05 has 1.07, and a block of ten rows then has
  /// 1.15 times the noise that neighbouring rows promise: what a floor may be off by (floor_excess).
  double tolerated_ratio = 1.07;
  /// Standard errors by which a ratio must miss it: Student's t of the chunks, 0.02 % on one side, since
  /// three signals of a log are tried in up to four ways and one healthy log in a hundred may be accused.
  double significance = 2e-4;
  /// A ratio beyond this is motion: first-order filtered noise has 4 at most.
  double motion_ratio = 5.0;
  /// Relative difference of standard deviations to a stated one that is clear.
  double stated_tolerance = 0.3;
  /// Share of repeated readings beyond which the resolution hides the noise: with normal noise of std s
  /// and a resolution q it is 0.28 q / s, here q = 1.4 s.
  double repeated_share = 0.4;
  /// Noise of so many steps of the resolution where the signal moves least is not hidden by it: rounding leaves a third of a step,
  /// and noise that it hides two thirds.
  double hidden_noise = 2.0;
  /// Steps of a resolution are multiples of it, and its readings come again. Where these shares of the steps and of the readings
  /// do not, readings were held: by a slower task, or until they left a deadband, which the smallest step then is at least this
  /// share of a usual one.
  double off_grid_share = 0.3, unique_share = 0.5, deadband_step = 0.4;
  /// A historian stores what leaves a deadband, and an export draws straight lines between: this share of readings lies on
  /// them (of white noise a hundredth does), corners are this many times the resolution, and at so many of them the signal turns
  /// back; or so many bend against the one before, by at most this share of a usual step. Those of a motion without noise do not.
  double straight_share = 0.3, corner_steps = 16, corner_turns = 0.1, corner_reversals = 0.3,
         corner_bend = 0.5;
  /// Growth of what exceeds white noise from pairs to four rows beyond which it is motion (8 for a corner, 32
  /// for curvature), not filtered noise (first order: up to 4.7).
  double motion_growth = 6;
  /// Energy over four rows, in that of single rows, that a trace of motion may have. More than that over two rows of a signal
  /// that moves may be motion or filtered noise.
  double motion_trace = 1.5;
  /// By how much the energy of all rows may exceed that of quiet ones: half of what a floor may be off by.
  double motion_share = 1.075;
  int chunks = 16;  ///< of time, the independent units
};

/// "1.2 bar"; units as people read them, differences of temperature in K.
Told WithUnit(double si, const std::string& unit);

/// Judges one signal over the strokes of a log; `period` in s. `stated`: SI, NaN if the machine file says
/// nothing. Fills everything but `share`.
SignalNoise JudgeSignalNoise(const std::string& name, const std::string& unit,
                             std::span<const SignalRuns> strokes, double period, double stated,
                             const SignalNoiseOptions& options = {});

}  // namespace hydroscope
