#pragma once

#include <Eigen/Dense>
#include <span>
#include <string>
#include <vector>

#include "core/told.h"
#include "estimation/signal_noise.h"
#include "estimation/span_equations.h"
#include "models/machine.h"
#include "models/model_structure.h"

namespace hydroscope {

/// Whether the noise floor of a balance, which rests on noise that is white from row to row, can be believed.
struct FloorTrust {
  bool believable = true;
  /// Signals of the base balance, largest share of its noise first.
  std::vector<SignalNoise> signals;
  /// Noise energy of the balance as far as it is known, over that of the contrasts: from the stated noise of
  /// the signals that the contrasts cannot judge, and from what coloured noise has over four rows (a lower
  /// bound). 1 if believable; NaN where a signal that counts is neither stated nor measurable.
  double noise_scale = 1;
  /// Not believable, but `noise_scale` is what the machine file states of the signals that count, of none of
  /// which the noise is filtered: a floor as good as the statement.
  bool stated = false;
  std::string why;  ///< one sentence; "" if believable
  /// Not believable for no other reason than that signals move from row to row: there may be less noise than the contrasts have,
  /// but what is there is white.
  bool only_moves = false;
  /// Believable, and a signal is slower than its rows, which is taken for motion: as noise it would matter. What it is; "" if
  /// there is none.
  Told may_be_noise;
  std::vector<Told> sentences;  ///< of signals that count, for `warnings`
};

/// Model error energy over noise energy that still counts as at the floor: what the noise estimate of a log of a minute
/// or two is unsure by (`hydroscope benchmark hidden-effects`, healthy machines called adequate).
inline constexpr double kFloorExcess = 0.15;

struct FloorTrustOptions {
  SignalNoiseOptions signal;
  /// A signal counts if it can change the noise energy of the balance by this share.
  double floor_excess = kFloorExcess;
  /// Energy of a signal's noise in the equations over that in their contrasts, beyond which the contrasts miss it: what passes the
  /// window of a rate is smooth from row to row. Less may be scatter of the dozen stretches that tell it.
  double unseen_ratio = 2;
};

/// Judges the floor of the base balance `theta` (regression parameters, SI; further entries are not looked
/// at) over the samples of `strokes`, each a stroke's stretches as the pipeline cut them. `machine` gives the
/// stated noise and the units. Deterministic; some milliseconds for a log of two minutes.
FloorTrust JudgeFloor(const ModelStructure& model, std::span<const std::vector<Stretch>> strokes,
                      const WindowSamples& window, const Eigen::VectorXd& theta, const Machine& machine,
                      const FloorTrustOptions& options = {});

}  // namespace hydroscope
