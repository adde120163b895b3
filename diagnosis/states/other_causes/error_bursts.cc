#include "diagnosis/states/other_causes/error_bursts.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/distributions.h"
#include "estimation/states/one_step.h"

namespace hydroscope {
namespace {

/// Squares over their mean, less 1; NaN stays.
std::vector<Eigen::VectorXd> ExcessSquares(std::vector<Eigen::VectorXd> innovations) {
  double sum = 0, count = 0;
  for (Eigen::VectorXd& one : innovations)
    for (double& value : one) {
      value *= value;
      if (!std::isfinite(value)) continue;
      sum += value;
      count += 1;
    }
  for (Eigen::VectorXd& one : innovations) one = one.array() * (count / std::max(sum, 1e-300)) - 1;
  return innovations;
}

/// Probability that noise of one strength correlates them as much over the first rows.
double PValue(const std::vector<Eigen::VectorXd>& squares, int lags) {
  double energy = 0, count = 0;
  Eigen::VectorXd products = Eigen::VectorXd::Zero(lags);
  for (const Eigen::VectorXd& one : squares)
    for (Eigen::Index row = 0; row < one.size(); ++row) {
      if (!std::isfinite(one[row])) continue;
      energy += one[row] * one[row];
      count += 1;
      for (Eigen::Index lag = 1; lag <= std::min<Eigen::Index>(lags, row); ++lag)
        if (const double product = one[row] * one[row - lag]; std::isfinite(product))
          products[lag - 1] += product;
    }
  if (!(energy > 0)) return 1;
  return ChiSquaredAbove(count * (products / energy).squaredNorm(), lags);
}

/// Where they are largest over so many rows.
ErrorBursts Strongest(const std::vector<Eigen::VectorXd>& squares, std::span<const Episode> episodes,
                      int rows) {
  ErrorBursts out;
  double most = -1;
  for (std::size_t e = 0; e < squares.size(); ++e)
    for (int first = 0; first + rows <= episodes[e].rows(); first += rows / 2) {
      const auto part = squares[e].segment(first, rows).array();
      const double sum = part.isFinite().select(part, 0).sum();
      if (sum <= most) continue;
      most = sum;
      out.from = episodes[e].time[static_cast<std::size_t>(first)];
      out.to = episodes[e].time[static_cast<std::size_t>(first + rows - 1)];
    }
  return out;
}

}  // namespace

std::optional<ErrorBursts> FindErrorBursts(const StateFit& fit, std::span<const Episode> episodes,
                                           const ErrorBurstsOptions& options) {
  std::optional<ErrorBursts> found;
  const auto outputs = static_cast<int>(fit.noise.size());
  for (int j = 0; j < outputs; ++j) {
    const std::vector<Eigen::VectorXd> squares = ExcessSquares(Innovations(fit, j));
    const double p = std::min(1.0, outputs * PValue(squares, options.lags));
    if (p > options.max_p || (found && found->p_value <= p)) continue;
    found = Strongest(squares, episodes, options.rows);
    found->p_value = p;
  }
  return found;
}

}  // namespace hydroscope
