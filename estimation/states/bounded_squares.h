#pragma once

#include <Eigen/SparseCore>
#include <functional>

namespace hydroscope {

/// Half a sum of squares at a point, with its normal equations.
struct SquaresSum {
  double cost = 0;
  Eigen::VectorXd gradient;              ///< J' r
  Eigen::SparseMatrix<double> products;  ///< J' J, the same places at every point
};

/// Half a sum of squares over unknowns within bounds.
struct BoundedSquares {
  Eigen::VectorXd low, high;
  /// Not finite where there is none: a model that diverges.
  std::function<double(const Eigen::VectorXd& at)> cost;
  /// Where the cost is finite; its own may not be, where sensitivities diverge and the model does not.
  std::function<SquaresSum(const Eigen::VectorXd& at)> sum;
};

struct DescentOptions {
  int iterations = 60;
  double tolerance = 1e-7;      ///< relative change of the cost at which a minimum is reached
  double same_point = 1e-10;    ///< ... or of the unknowns
  double first_radius = 1e4;    ///< the curvature of each unknown is raised by its inverse share
  double least_quality = 1e-3;  ///< of the decrease foreseen, from which on a step is taken
  double least_radius = 1e-12;  ///< steps that are damped more lead nowhere
  int most_refused = 20;        ///< ... nor do those after so many refused ones
};

struct Descent {
  bool begun = false;      ///< the cost is finite where it began
  bool converged = false;  ///< to the tolerance, in fewer iterations than it might have taken
  double cost = 0;
};

/// Levenberg and Marquardt's method (Marquardt 1963; radius after Nielsen 1999) within bounds, in place. Each step minimises the
/// damped quadratic model within the bounds: unknowns that would leave them stand at them and the others are solved for anew
/// (active set; Nocedal and Wright 2006, 16.7), for what stands at a bound else spoils the steps of all others.
Descent Minimise(const BoundedSquares& squares, const DescentOptions& options, Eigen::VectorXd& at);

}  // namespace hydroscope
