#pragma once

#include <Eigen/Dense>
#include <span>
#include <string>
#include <vector>

#include "core/told.h"
#include "estimation/floor_trust.h"
#include "estimation/span_equations.h"
#include "models/model_structure.h"

namespace hydroscope {

/// Whether rows are dense enough for what a balance integrates and differentiates.
struct SamplingRate {
  bool fast_enough = true;
  double period = 0;          ///< s between rows
  double needed_period = 0;   ///< s, at most; `period` or more if fast enough
  double needed_rate_hz = 0;  ///< 1 / needed_period
  double error = 0;           ///< output unit rms, of the balance, that the distance of the rows causes alone
  double allowed = 0;         ///< output unit rms
  double output = 0;          ///< output unit rms, over the same windows
  /// "sampled too slowly for this: rows every ...", or "noise of ... comes in bursts, or rows every ..."; "" if fast enough
  Told sentence;
  Told why;  ///< the same in a word or two, for a parameter: "sampled too slowly"; "" if fast enough
};

struct SamplingRateOptions {
  /// Error allowed in the noise floor (energy share floor_excess 0.15: 0.39 of the floor), ...
  double floor_share = 0.39;
  /// ... but not below and not above these shares of the output, whatever a floor says: what is left of a model that is
  /// right to 0.5 % misleads nobody, and a floor of motion that was taken for noise excuses nothing.
  double least_share = 0.005, most_share = 0.02;
  /// Ratio of pairs to single rows whose 95 % band lies within this factor: white, whatever its size.
  double white_ratio = 1.3;
  /// Otherwise a contrast beyond this share of a signal's own range is not taken for sensor noise.
  double noise_of_range = 0.05;
  /// Scatter beyond the quiet rows may be noise in bursts where all rows have more than this energy, in that of the quiet ones, and
  /// what is more grows by less than this from single rows to pairs: 0.6 to 1.5 of few bursts (sampling_rate_test.cc), motion alone 8.
  double burst_energy = 2, burst_growth = 1.5;
};

/// Error of the base balance by the distance of its rows. The balance `theta` (SI, regression parameters) is
/// computed from all rows, from every second and from every fourth: where the differences of the three shrink
/// with the order p, that of all rows against none missing is the first divided by 2^p - 1 (Richardson 1911).
/// What sensor noise adds to the difference is found by adding as much noise again, and taken out. Signals
/// whose scatter may be their own motion (`trust`) count as free of noise. `noise_floor` in output units.
SamplingRate JudgeSamplingRate(const ModelStructure& model, std::span<const std::vector<Stretch>> strokes,
                               const WindowSamples& window, const Eigen::VectorXd& theta,
                               const FloorTrust& trust, double noise_floor,
                               const SamplingRateOptions& options = {});

}  // namespace hydroscope
