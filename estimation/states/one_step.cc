#include "estimation/states/one_step.h"

#include <cmath>

#include "estimation/decompositions.h"

namespace hydroscope {

double OneStepError(const StateFit& fit, int output) {
  constexpr int kOrder = 4;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(kOrder + 1, kOrder + 1);
  double count = 0;
  for (const RowMatrix& residual : fit.residuals)
    for (Eigen::Index row = kOrder; row < residual.rows(); ++row) {
      const Eigen::VectorXd past = residual.col(output).segment(row - kOrder, kOrder + 1);
      if (!past.allFinite()) continue;
      information += past * past.transpose();
      count += 1;
    }
  if (!(count > 2 * kOrder)) return fit.noise[output];
  return std::sqrt(EnergyLeft(information) / count);
}

double OneStepShare(const StateFit& fit) {
  double sum = 0;
  for (int j = 0; j < fit.noise.size(); ++j) sum += std::pow(OneStepError(fit, j) / fit.noise[j], 2);
  return sum / static_cast<double>(fit.noise.size());
}

}  // namespace hydroscope
