#include "estimation/linear_form/base_parameters.h"

namespace hydroscope {

BaseParameterSet FindBaseParameters(const Eigen::MatrixXd& regressor, double tolerance) {
  const Eigen::VectorXd length = regressor.colwise().norm();
  Eigen::MatrixXd scaled = regressor;
  for (Eigen::Index j = 0; j < scaled.cols(); ++j)
    if (length[j] > 0) scaled.col(j) /= length[j];
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> revealing(scaled);
  revealing.setThreshold(tolerance);
  BaseParameterSet base;
  base.rank = static_cast<int>(revealing.rank());

  // Orthonormal directions of the columns kept so far; twice, so that rounding does not make one of nothing.
  Eigen::MatrixXd directions(scaled.rows(), base.rank);
  for (Eigen::Index j = 0; j < scaled.cols(); ++j) {
    if (!(length[j] > 0)) {
      base.unseen.push_back(static_cast<int>(j));
      continue;
    }
    const auto kept = static_cast<Eigen::Index>(base.kept.size());
    Eigen::VectorXd rest = scaled.col(j);
    for (int pass = 0; pass < 2; ++pass)
      rest -= directions.leftCols(kept) * (directions.leftCols(kept).transpose() * rest);
    if (kept >= base.rank || rest.norm() <= tolerance) continue;
    directions.col(kept) = rest.normalized();
    base.kept.push_back(static_cast<int>(j));
  }

  Eigen::MatrixXd independent(scaled.rows(), static_cast<Eigen::Index>(base.kept.size()));
  for (std::size_t k = 0; k < base.kept.size(); ++k) independent.col(k) = scaled.col(base.kept[k]);
  if (base.kept.empty()) return base;
  base.combination = independent.householderQr().solve(scaled);
  for (std::size_t k = 0; k < base.kept.size(); ++k)
    base.combination.row(k) = base.combination.row(k).cwiseProduct(length.transpose()) / length[base.kept[k]];
  base.combination = (base.combination.array().abs() > 10 * tolerance).select(base.combination, 0.0);
  const Eigen::VectorXd singular = independent.jacobiSvd().singularValues();
  base.condition = singular[0] / singular[singular.size() - 1];
  return base;
}

}  // namespace hydroscope
