#include "estimation/recursive/information_filter.h"

#include <cmath>
#include <limits>

namespace hydroscope {

InformationFilter::InformationFilter(const Vector& initial, double covariance, double max_covariance)
    : least_information_(1.0 / max_covariance) {
  const auto n = initial.size();
  information_ = Matrix::Identity(n, n) / covariance;
  state_ = initial / covariance;
  moment_ = Matrix::Constant(n, n, std::numeric_limits<double>::quiet_NaN());
}

InformationFilter::InformationFilter(const Matrix& information, const Vector& state, const Matrix& moment,
                                     double least_information)
    : least_information_(least_information), information_(information), state_(state), moment_(moment) {}

void InformationFilter::Forget(const Matrix& basis, double mu) {
  if (basis.cols() == 0 || mu >= 1.0) return;
  const Knowledge before{information_, state_, moment_};
  const Matrix ra = information_ * basis;
  const Matrix ara = basis.transpose() * ra;
  // F = I - (1 - mu) R A (A' R A)^-1 A'; symmetric R <- F R, and F is applied to all that R multiplies.
  const Matrix lost = (1.0 - mu) * ra * ara.llt().solve(basis.transpose());
  const Matrix less = lost * information_;
  information_ -= 0.5 * (less + less.transpose());
  state_ -= lost * state_;
  moment_ -= lost * moment_;
  KeepBounded(before);
}

void InformationFilter::Add(const Matrix& gram, const Vector& cross, double condition) {
  if (std::isfinite(condition) && moment_.hasNaN()) moment_ = information_ * condition;
  const Knowledge before{information_, state_, moment_};
  if (std::isfinite(condition))
    moment_ += gram * condition;
  else
    moment_ += gram * ConditionMatrix();
  information_ += gram;
  state_ += cross;
  KeepBounded(before);
}

void InformationFilter::KeepBounded(const Knowledge& before) {
  // R - least I positive definite: every direction has enough. A factor is much cheaper than eigenvalues.
  const auto n = information_.rows();
  const Eigen::LLT<Matrix> enough(information_ - least_information_ * Matrix::Identity(n, n));
  if (enough.info() == Eigen::Success) return;
  const auto known = before.information.ldlt();
  const Vector theta = known.solve(before.state);
  const Matrix condition = known.solve(before.moment);
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(information_);
  for (Eigen::Index d = 0; d < theta.size(); ++d) {
    const double missing = least_information_ - eigen.eigenvalues()[d];
    if (!(missing > 0)) continue;
    const Vector direction = eigen.eigenvectors().col(d);
    information_ += missing * (direction * direction.transpose());
    state_ += direction * (least_information_ * direction.dot(theta) - direction.dot(state_));
    moment_ += direction *
               (least_information_ * direction.transpose() * condition - direction.transpose() * moment_);
  }
}

InformationFilter::Vector InformationFilter::Theta() const { return information_.ldlt().solve(state_); }

InformationFilter::Matrix InformationFilter::Covariance() const {
  const auto n = information_.rows();
  const Matrix inverse = information_.ldlt().solve(Matrix::Identity(n, n));
  return 0.5 * (inverse + inverse.transpose());
}

InformationFilter::Matrix InformationFilter::ConditionMatrix() const {
  return information_.ldlt().solve(moment_);
}

InformationFilter::Vector InformationFilter::Condition() const { return ConditionMatrix().diagonal(); }

}  // namespace hydroscope
