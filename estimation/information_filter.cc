#include "estimation/information_filter.h"

namespace hydroscope {

InformationFilter::InformationFilter(const Vector& initial, double covariance) {
  const auto n = initial.size();
  information_ = Matrix::Identity(n, n) / covariance;
  state_ = initial / covariance;
}

void InformationFilter::Forget(const Matrix& basis, double mu) {
  if (basis.cols() == 0 || mu >= 1.0) return;
  const auto n = information_.rows(), r = basis.cols();
  Matrix ra = Matrix::Zero(n, r), ara = Matrix::Zero(r, r);
  ra.noalias() = information_.lazyProduct(basis);
  ara.noalias() = basis.transpose().lazyProduct(ra);
  const Eigen::LLT<Matrix> factor(ara);
  if (factor.info() != Eigen::Success) return;
  // R A (A' R A)^-1 A' R = W' W with W = L^-1 A' R; the state loses W' L^-1 A' s.
  Matrix w = ra.transpose();
  factor.matrixL().solveInPlace(w);
  Vector t = Vector::Zero(r);
  t.noalias() = basis.transpose().lazyProduct(state_);
  factor.matrixL().solveInPlace(t);
  for (Eigen::Index k = 0; k < r; ++k)
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) information_(i, j) -= (1.0 - mu) * (w(k, i) * w(k, j));
      state_[i] -= (1.0 - mu) * w(k, i) * t[k];
    }
}

void InformationFilter::Add(const Matrix& gram, const Vector& cross, double weight) {
  information_ += weight * gram;
  state_ += weight * cross;
}

InformationFilter::Vector InformationFilter::Theta() const { return information_.ldlt().solve(state_); }

InformationFilter::Matrix InformationFilter::Covariance() const {
  const auto n = information_.rows();
  const Matrix inverse = information_.ldlt().solve(Matrix::Identity(n, n));
  return 0.5 * (inverse + inverse.transpose());
}

void InformationFilter::Restore(const Matrix& information, const Vector& state) {
  information_ = information;
  state_ = state;
}

}  // namespace hydroscope
