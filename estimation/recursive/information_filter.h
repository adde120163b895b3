#pragma once

#include <Eigen/Dense>

#include "core/limits.h"

namespace hydroscope {

/// Recursive least squares in information form, stroke by stroke: R = P^-1 and s = R theta, in scaled units
/// with noise of unit variance. Information form, because what a stroke adds is its Gram less the share that
/// sensor noise has in it,
///   R <- R + S - N,  s <- s + g - n,
/// which takes the errors-in-variables bias out (bias-compensated least squares, Stoica and Soderstrom 1982)
/// and which a factor of P cannot take in one piece. A direction that a stroke does not move adds nothing but
/// a noise of zero mean.
///
/// Directional forgetting for a set of equations at once (SIFt-RLS, Lai and Bernstein 2024, arXiv 2404.10844): the
/// subspace spanned by A, the directions the stroke excites, loses the share 1 - mu of its information,
///   R <- R - (1 - mu) R A (A' R A)^-1 A' R,  and s with it; all other directions keep theirs.
///
/// Bounded covariance: no eigenvalue of P exceeds `max_covariance`. A direction whose information would fall
/// below 1 / max_covariance, by forgetting or by a noise share that chance made larger than the Gram, is held
/// there, and the parameters with it. R is therefore positive definite whatever happens.
///
/// Condition: the filter remembers under which condition (a scalar, here the oil temperature) it learned, with the very
/// weights the data have in theta: M <- M + (S - N) c, forgotten like s. If parameter i follows the condition linearly,
/// its estimate is the parameter at condition(i) = (R^-1 M)_ii, not at the present one.
class InformationFilter {
 public:
  static constexpr int kMost = kMaxParameters + 1;  ///< with the output beside them
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;

  /// Starts at theta = `initial` with P = `covariance` * I; `max_covariance` >= `covariance`.
  InformationFilter(const Vector& initial, double covariance, double max_covariance);
  /// Goes on where another one was.
  InformationFilter(const Matrix& information, const Vector& state, const Matrix& moment,
                    double least_information);

  /// `basis`: orthonormal, parameters x r; `mu` in (0, 1].
  void Forget(const Matrix& basis, double mu);
  /// Adds information `gram` and `cross`, learned at `condition`. An unknown condition (NaN) is taken as the
  /// one remembered; what came before the first known one, as that.
  void Add(const Matrix& gram, const Vector& cross, double condition);

  Vector Theta() const;
  Matrix Covariance() const;
  /// Condition each parameter stands for; NaN before the first known one.
  Vector Condition() const;

  const Matrix& information() const { return information_; }
  const Vector& state() const { return state_; }
  const Matrix& moment() const { return moment_; }
  double least_information() const { return least_information_; }

 private:
  /// What the filter knew before a step.
  struct Knowledge {
    Matrix information;
    Vector state;
    Matrix moment;
  };
  /// Holds directions with too little information left at what was known `before`.
  void KeepBounded(const Knowledge& before);
  Matrix ConditionMatrix() const;

  double least_information_;
  Matrix information_;
  Vector state_;
  Matrix moment_;  ///< M; NaN before the first known condition
};

}  // namespace hydroscope
