#include "estimation/states/one_step.h"

#include <cmath>
#include <limits>

#include "estimation/decompositions.h"

namespace hydroscope {
namespace {

constexpr int kOrder = 4;

/// An error after its past ones; not finite where one is not known.
Eigen::VectorXd WithPast(const RowMatrix& residual, int output, Eigen::Index row) {
  return residual.col(output).segment(row - kOrder, kOrder + 1);
}

/// Products of an output's error and its past ones, all with all.
struct PastErrors {
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(kOrder + 1, kOrder + 1);
  double count = 0;

  PastErrors(const StateFit& fit, int output) {
    for (const RowMatrix& residual : fit.residuals)
      for (Eigen::Index row = kOrder; row < residual.rows(); ++row) {
        const Eigen::VectorXd past = WithPast(residual, output, row);
        if (!past.allFinite()) continue;
        products += past * past.transpose();
        count += 1;
      }
  }
  bool enough() const { return count > 2 * kOrder; }
};

}  // namespace

double OneStepError(const StateFit& fit, int output) {
  const PastErrors past(fit, output);
  return past.enough() ? std::sqrt(EnergyLeft(past.products) / past.count) : fit.noise[output];
}

std::vector<Eigen::VectorXd> Innovations(const StateFit& fit, int output) {
  const PastErrors past(fit, output);
  Eigen::VectorXd regression = Eigen::VectorXd::Zero(kOrder + 1);  // of the error on itself and its past
  if (past.enough())
    regression.head(kOrder) = -SymmetricFactor(past.products.topLeftCorner(kOrder, kOrder))
                                   .Solve(past.products.col(kOrder).head(kOrder));
  regression[kOrder] = 1;
  std::vector<Eigen::VectorXd> innovations;
  for (const RowMatrix& residual : fit.residuals) {
    Eigen::VectorXd& one = innovations.emplace_back(
        Eigen::VectorXd::Constant(residual.rows(), std::numeric_limits<double>::quiet_NaN()));
    for (Eigen::Index row = kOrder; row < residual.rows(); ++row)
      one[row] = regression.dot(WithPast(residual, output, row));
  }
  return innovations;
}

double OneStepShare(const StateFit& fit) {
  double sum = 0;
  for (int j = 0; j < fit.noise.size(); ++j) sum += std::pow(OneStepError(fit, j) / fit.noise[j], 2);
  return sum / static_cast<double>(fit.noise.size());
}

}  // namespace hydroscope
