#include "estimation/decompositions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>

namespace hydroscope {

SymmetricEigen EigenOf(const Eigen::MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

SymmetricFactor::SymmetricFactor(const Eigen::MatrixXd& symmetric) : factor_(symmetric) {}
double SymmetricFactor::LeastPivot() const { return factor_.vectorD().minCoeff(); }
Eigen::VectorXd SymmetricFactor::Solve(const Eigen::VectorXd& right) const { return factor_.solve(right); }
Eigen::MatrixXd SymmetricFactor::SolveColumns(const Eigen::MatrixXd& right) const {
  return factor_.solve(right);
}

namespace {

/// Of a squared length of 1: columns that differ by less count as the same.
constexpr double kRidge = 1e-10;
constexpr double kLeastLength = 1e-300;  // squared

Eigen::VectorXd ScalesOf(const Eigen::MatrixXd& products) {
  return products.diagonal().cwiseMax(kLeastLength).cwiseSqrt().cwiseInverse();
}

Eigen::MatrixXd WithRidge(const Eigen::MatrixXd& products, const Eigen::VectorXd& scale) {
  Eigen::MatrixXd scaled = scale.asDiagonal() * products * scale.asDiagonal();
  scaled.diagonal().array() += kRidge;
  return scaled;
}

}  // namespace

ScaledFactor::ScaledFactor(const Eigen::MatrixXd& products)
    : scale_(ScalesOf(products)), factor_(WithRidge(products, scale_)) {}
Eigen::VectorXd ScaledFactor::Solve(const Eigen::VectorXd& right) const {
  return scale_.cwiseProduct(factor_.Solve(scale_.cwiseProduct(right)));
}
Eigen::MatrixXd ScaledFactor::SolveColumns(const Eigen::MatrixXd& right) const {
  return scale_.asDiagonal() * factor_.SolveColumns(scale_.asDiagonal() * right);
}

double EnergyLeft(const Eigen::MatrixXd& products) {
  const Eigen::Index last = products.rows() - 1;
  Eigen::MatrixXd own = products.topLeftCorner(last, last);
  own.diagonal().array() *= 1 + 1e-9;
  const Eigen::VectorXd cross = products.col(last).head(last);
  return std::max(0.0, products(last, last) - cross.dot(SymmetricFactor(own).Solve(cross)));
}

PositiveFactor::PositiveFactor(const Eigen::MatrixXd& positive) : factor_(positive) {}
Eigen::MatrixXd PositiveFactor::SolveColumns(const Eigen::MatrixXd& right) const {
  return factor_.solve(right);
}
Eigen::MatrixXd PositiveFactor::SolveLower(const Eigen::MatrixXd& right) const {
  return factor_.matrixL().solve(right);
}
Eigen::VectorXd PositiveFactor::SolveLower(const Eigen::VectorXd& right) const {
  return factor_.matrixL().solve(right);
}
Eigen::MatrixXd PositiveFactor::SolveUpper(const Eigen::MatrixXd& right) const {
  return factor_.matrixU().solve(right);
}

Eigen::MatrixXd Inverse(const Eigen::MatrixXd& square) { return square.inverse(); }
Eigen::MatrixXd PseudoInverse(const Eigen::MatrixXd& any) {
  return any.completeOrthogonalDecomposition().pseudoInverse();
}
Eigen::MatrixXd OrthonormalBasis(const Eigen::MatrixXd& tall) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(tall).householderQ() *
         Eigen::MatrixXd::Identity(tall.rows(), tall.cols());
}

}  // namespace hydroscope
