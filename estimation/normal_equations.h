#pragma once

#include <Eigen/Dense>

namespace hydroscope {

/// Normal equations of chosen regressors in one stroke: least squares minimises theta' h theta - 2 theta' g + yy.
struct NormalEquations {
  Eigen::MatrixXd h;
  Eigen::VectorXd g;
  double yy = 0;
  double equations = 0;

  NormalEquations& operator+=(const NormalEquations& other);
  NormalEquations& operator-=(const NormalEquations& other);
};

/// Condition of regressors scaled to a unit diagonal, and least share of one that the others do not explain, down to which their
/// equations have a solution: some hundred times the rounding of double precision.
inline constexpr double kLeastCondition = 1e-13;

/// Least squares with the regressors scaled to unit diagonal; empty if the regressors are not independent.
Eigen::VectorXd SolveNormalEquations(const NormalEquations& equations);

/// Mean squared error of `theta` on these equations, output unit squared.
double MeanSquaredError(const NormalEquations& equations, const Eigen::VectorXd& theta);

}  // namespace hydroscope
