#pragma once

#include <Eigen/Dense>

namespace hydroscope {

/// Recursive least squares in information form, span by span: R = P^-1 and s = R theta, in scaled units with noise of
/// unit variance. Information form, because what a span adds is its Gram less the share that sensor noise has in it,
///   R <- R + S - N,  s <- s + g - n,
/// which takes the errors-in-variables bias out (bias-compensated least squares, Stoica and Soderstrom 1982) and which a
/// factor of P cannot take in one piece. A direction that a span does not move adds nothing but a noise of zero mean.
///
/// Directional forgetting for a set of equations at once (SIFt-RLS, Lai and Bernstein 2024, arXiv 2404.10844): the
/// subspace spanned by A, the directions the span excites, loses the share 1 - mu of its information,
///   R <- R - (1 - mu) R A (A' R A)^-1 A' R,  and s with it; all other directions keep theirs.
class InformationFilter {
 public:
  static constexpr int kMaxParameters = 12;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxParameters, kMaxParameters>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxParameters, 1>;

  /// Starts at theta = `initial` with P = `covariance` * I.
  InformationFilter(const Vector& initial, double covariance);

  /// `basis`: orthonormal, parameters x r; `mu` in (0, 1].
  void Forget(const Matrix& basis, double mu);
  /// Adds weighted information `weight * gram` and `weight * cross`.
  void Add(const Matrix& gram, const Vector& cross, double weight);

  Vector Theta() const;
  Matrix Covariance() const;
  const Matrix& information() const { return information_; }
  const Vector& state() const { return state_; }
  void Restore(const Matrix& information, const Vector& state);

 private:
  Matrix information_;
  Vector state_;
};

}  // namespace hydroscope
