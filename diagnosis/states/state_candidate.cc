#include "diagnosis/states/state_candidate.h"

#include <algorithm>
#include <cmath>

#include "estimation/states/one_step.h"

namespace hydroscope {
namespace {

/// Readings over which the errors of a fit are correlated: 1 + 2 sum of their autocorrelation until it first vanishes.
double CorrelatedReadings(const StateFit& fit) {
  constexpr Eigen::Index kLags = 100;
  double longest = 1;
  for (Eigen::Index j = 0; j < fit.noise.size(); ++j) {
    double sum = 1;
    for (Eigen::Index lag = 1; lag <= kLags; ++lag) {
      double product = 0, energy = 0;
      for (const RowMatrix& residual : fit.residuals)
        for (Eigen::Index row = lag; row < residual.rows(); ++row) {
          const double now = residual(row, j), then = residual(row - lag, j);
          if (!std::isfinite(now) || !std::isfinite(then)) continue;
          product += now * then;
          energy += now * now;
        }
      if (!(product > 0)) break;
      sum += 2 * product / energy;
    }
    longest = std::max(longest, sum);
  }
  return longest;
}

}  // namespace

double ErrorLeftOut(const StateFit& fit) {
  const double rms = fit.noise.size() == 1 ? fit.noise[0]
                                           : std::sqrt(fit.noise.cwiseQuotient(fit.scale).squaredNorm() /
                                                       static_cast<double>(fit.noise.size()));
  double energy = 0;
  for (const StatePiece& piece : fit.pieces) energy += piece.energy;
  return rms * std::sqrt(fit.HeldOutEnergy() / std::max(energy, 1e-300 * std::max(1, fit.readings())));
}

std::pair<double, double> PairedGain(const std::vector<double>& before, const std::vector<double>& after) {
  const auto n = static_cast<double>(before.size());
  double sum = 0, squares = 0;
  for (std::size_t k = 0; k < before.size(); ++k) sum += before[k] - after[k];
  for (std::size_t k = 0; k < before.size(); ++k) {
    const double d = before[k] - after[k] - sum / n;
    squares += d * d;
  }
  const double error = std::sqrt(squares * n / std::max(n - 1, 1.0));
  return {sum, error > 0 ? sum / error : 0.0};
}

double EvidenceOf(const StateCandidate& candidate) {
  return candidate.held_out / std::max(1, candidate.fit.readings()) * CorrelatedReadings(candidate.fit);
}

bool LeavesColoured(const StateCandidate& candidate, double white_readings) {
  return CorrelatedReadings(candidate.fit) > white_readings ||
         white_readings * OneStepShare(candidate.fit) < 1;
}

}  // namespace hydroscope
