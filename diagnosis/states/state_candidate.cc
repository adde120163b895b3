#include "diagnosis/states/state_candidate.h"

#include <algorithm>
#include <cmath>

#include "diagnosis/states/added_effect.h"

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

/// Terms that a candidate adds to each equation along its own run, over the size of the equation's rate there.
Eigen::MatrixXd TermsOf(const StateModel& near, const StateCandidate& candidate,
                        std::span<const Episode> episodes) {
  const StateModel& with = *candidate.fit.model;
  AddedEffect effect(near, with, candidate.fit.parameters.head(near.parameter_count()));
  effect.AddDraw(candidate.fit.parameters);
  const auto equations = static_cast<Eigen::Index>(with.states() + with.output.rows);
  std::vector<Eigen::VectorXd> rows;
  Eigen::VectorXd size = Eigen::VectorXd::Zero(equations);
  std::vector<double> values(effect.equations().size()), input(static_cast<std::size_t>(with.driving()));
  for (std::size_t e = 0; e < episodes.size(); ++e)
    for (int row = 0; row + 1 < episodes[e].rows(); ++row) {
      for (std::size_t i = 0; i < with.inputs.size(); ++i) input[i] = episodes[e].signal(row, with.inputs[i]);
      const StateRun& run = candidate.fit.runs[e];
      const Eigen::VectorXd state = run.states.row(row).transpose();
      effect.Values(state.data(), input.data(), values.data());
      Eigen::VectorXd terms = Eigen::VectorXd::Zero(equations);
      for (std::size_t k = 0; k < values.size(); ++k) terms[effect.equations()[k]] = values[k];
      rows.push_back(std::move(terms));
      const double period = episodes[e].time[static_cast<std::size_t>(row) + 1] -
                            episodes[e].time[static_cast<std::size_t>(row)];
      size.head(with.states()) +=
          ((run.states.row(row + 1) - run.states.row(row)) / period).cwiseAbs2().transpose();
      size.tail(with.output.rows) += candidate.fit.scale.cwiseAbs2();
    }
  Eigen::MatrixXd out(static_cast<Eigen::Index>(rows.size()), equations);
  for (std::size_t r = 0; r < rows.size(); ++r)
    out.row(static_cast<Eigen::Index>(r)) =
        rows[r].cwiseQuotient(size.cwiseMax(1e-300).cwiseSqrt()).transpose();
  return out;
}

}  // namespace

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

bool SameLaw(const StateFit& base, const StateCandidate& a, const StateCandidate& b,
             std::span<const Episode> episodes, double share) {
  // What a delayed input is at a row is not at hand here.
  if (a.fit.model->delays.size() != base.model->delays.size() ||
      a.fit.model->delays.size() != b.fit.model->delays.size() || !a.fit.model->delays.empty())
    return false;
  const Eigen::MatrixXd of_a = TermsOf(*base.model, a, episodes), of_b = TermsOf(*base.model, b, episodes);
  return (of_a - of_b).norm() <= share * of_a.norm();
}

}  // namespace hydroscope
