#include "estimation/states/bounded_squares.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace hydroscope {
namespace {

/// Minimum of gradient' step + step' (products + damping) step / 2 within bounds.
class BoundedStep {
 public:
  BoundedStep(const BoundedSquares& squares, const SquaresSum& sum, const Eigen::VectorXd& at)
      : sum_(sum), low_(squares.low - at), high_(squares.high - at) {
    factor_.analyzePattern(sum.products);
  }

  /// Not finite where the equations cannot be solved.
  Eigen::VectorXd Damped(double radius) {
    constexpr double kLeastCurvature = 1e-12;  // of what changes nothing
    const Eigen::Index n = low_.size();
    damping_ = Eigen::VectorXd(sum_.products.diagonal()).cwiseMax(kLeastCurvature) / radius;
    stands_.assign(static_cast<std::size_t>(n), false);
    Eigen::VectorXd step = Eigen::VectorXd::Zero(n);
    for (Eigen::Index i = 0; i < n; ++i)
      stands_[static_cast<std::size_t>(i)] =
          (low_[i] >= 0 && sum_.gradient[i] > 0) || (high_[i] <= 0 && sum_.gradient[i] < 0);
    for (Eigen::Index round = 0; round <= n; ++round) {
      const Eigen::VectorXd wanted = Solved(step);
      if (!wanted.allFinite() || !GoTowards(wanted, step)) return wanted;
    }
    return step;
  }

  /// By which the quadratic model without damping falls.
  double Foreseen(const Eigen::VectorXd& step) const {
    return -(sum_.gradient.dot(step) + 0.5 * step.dot(sum_.products * step));
  }

 private:
  /// The minimum over what does not stand, the rest at its place in `step`.
  Eigen::VectorXd Solved(const Eigen::VectorXd& step) {
    Eigen::VectorXd held = step;
    for (Eigen::Index i = 0; i < held.size(); ++i)
      if (!stands_[static_cast<std::size_t>(i)]) held[i] = 0;
    Eigen::VectorXd right = -sum_.gradient - sum_.products * held;
    Eigen::SparseMatrix<double> matrix = sum_.products;
    for (Eigen::Index column = 0; column < matrix.outerSize(); ++column)
      for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix, column); entry; ++entry) {
        const bool own = entry.row() == column;
        if (stands_[static_cast<std::size_t>(entry.row())] || stands_[static_cast<std::size_t>(column)])
          entry.valueRef() = own ? 1.0 : 0.0;
        else if (own)
          entry.valueRef() += damping_[column];
      }
    for (Eigen::Index i = 0; i < right.size(); ++i)
      if (stands_[static_cast<std::size_t>(i)]) right[i] = held[i];
    factor_.factorize(matrix);
    if (factor_.info() != Eigen::Success)
      return Eigen::VectorXd::Constant(right.size(), std::numeric_limits<double>::quiet_NaN());
    return factor_.solve(right);
  }

  /// From `step` towards `wanted` up to the first bound, where that unknown stands from now on. False: there is none on the way.
  bool GoTowards(const Eigen::VectorXd& wanted, Eigen::VectorXd& step) {
    double share = 1;
    Eigen::Index first = -1;
    for (Eigen::Index i = 0; i < wanted.size(); ++i) {
      if (stands_[static_cast<std::size_t>(i)]) continue;
      const double bound = wanted[i] < low_[i] ? low_[i] : wanted[i] > high_[i] ? high_[i] : wanted[i];
      if (bound == wanted[i]) continue;
      const double reached = std::max(0.0, (bound - step[i]) / (wanted[i] - step[i]));
      if (reached >= share) continue;
      share = reached;
      first = i;
    }
    if (first < 0) return false;
    step += share * (wanted - step);
    step[first] = wanted[first] < low_[first] ? low_[first] : high_[first];
    stands_[static_cast<std::size_t>(first)] = true;
    return true;
  }

  const SquaresSum& sum_;
  Eigen::VectorXd low_, high_, damping_;  ///< bounds of the step
  std::vector<bool> stands_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace

Descent Minimise(const BoundedSquares& squares, const DescentOptions& options, Eigen::VectorXd& at) {
  Descent descent;
  at = at.cwiseMax(squares.low).cwiseMin(squares.high);
  descent.cost = squares.cost(at);
  if (!std::isfinite(descent.cost)) return descent;
  descent.begun = true;
  double radius = options.first_radius, shrinks = 2;
  int refused = 0;
  SquaresSum sum = squares.sum(at);
  for (int k = 0; k < options.iterations && !descent.converged; ++k) {
    if (k > 0) sum = squares.sum(at);
    if (!std::isfinite(sum.cost)) break;
    BoundedStep bounded(squares, sum, at);
    for (bool taken = false; !taken;) {
      const Eigen::VectorXd step = bounded.Damped(radius);
      const double foreseen = step.allFinite() ? bounded.Foreseen(step) : 0;
      if (step.allFinite() && step.norm() <= options.same_point * (at.norm() + options.same_point)) {
        descent.converged = true;
        break;
      }
      Eigen::VectorXd next = (at + step).cwiseMax(squares.low).cwiseMin(squares.high);
      const double cost = foreseen > 0 ? squares.cost(next) : std::numeric_limits<double>::infinity();
      const double gain = descent.cost - cost, quality = gain / foreseen;
      taken = std::isfinite(cost) && quality > options.least_quality;
      if (!taken) {
        radius /= shrinks;
        shrinks *= 2;
        if (++refused >= options.most_refused || radius < options.least_radius) {
          descent.converged = true;
          break;
        }
        continue;
      }
      refused = 0;
      radius = std::min(radius / std::max(1.0 / 3, 1 - std::pow(2 * quality - 1, 3)), 1e16);
      shrinks = 2;
      descent.converged = gain < options.tolerance * descent.cost;
      at = std::move(next);
      descent.cost = cost;
    }
  }
  return descent;
}

}  // namespace hydroscope
