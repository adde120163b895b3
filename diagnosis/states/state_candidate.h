#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "estimation/states/fit.h"

namespace hydroscope {

/// A model with some effects added to it: fitted, or what linearisation foresees of it.
struct StateCandidate {
  std::vector<std::string> added;
  StateFit fit;         ///< of no model where it was not worth a fit
  double held_out = 0;  ///< energy left out over the base's noise
  double gain = 0;      ///< against the model as it is, in noise variances
  double t = 0;         ///< ... over its standard error

  bool fitted() const { return fit.model != nullptr && fit.solved(); }
};

/// What a fit leaves of pieces left out, rms: of one output SI, of several as a share of each output's variation (root of the mean
/// of squares), whatever they were weighed by.
double ErrorLeftOut(const StateFit& fit);

/// How much lower the second energies are: sum, and its t over the pieces.
std::pair<double, double> PairedGain(const std::vector<double>& before, const std::vector<double>& after);

/// Energy that counts as one piece of evidence: that of a reading, times the readings over which errors are correlated.
double EvidenceOf(const StateCandidate& candidate);

/// Whether a candidate leaves errors that hang together over more than so many readings, or that past ones foresee to so large a
/// part: no white noise does, and every wrong minimum.
bool LeavesColoured(const StateCandidate& candidate, double white_readings);

}  // namespace hydroscope
