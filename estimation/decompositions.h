#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

// Decompositions of dense matrices, each compiled once: their templates take longer to compile than all that uses them. For matrices
// of any size that are decomposed once a stroke or more seldom.
namespace hydroscope {

/// Of a symmetric matrix, of which the lower triangle is read.
struct SymmetricEigen {
  Eigen::VectorXd values;   ///< ascending
  Eigen::MatrixXd vectors;  ///< orthonormal, one a column
};
SymmetricEigen EigenOf(const Eigen::MatrixXd& symmetric);

/// P'LDL'P of a symmetric matrix with pivoting (Bunch and Kaufman 1977 without 2 x 2 pivots); its lower triangle is read.
class SymmetricFactor {
 public:
  explicit SymmetricFactor(const Eigen::MatrixXd& symmetric);

  bool sound() const { return factor_.info() == Eigen::Success; }
  double LeastPivot() const;  ///< of D
  Eigen::VectorXd Solve(const Eigen::VectorXd& right) const;
  Eigen::MatrixXd SolveColumns(const Eigen::MatrixXd& right) const;

 private:
  Eigen::LDLT<Eigen::MatrixXd> factor_;
};

/// The same of products of columns with one another, positive semidefinite, each column brought to length 1 before: what one is
/// measured in changes no pivot. Columns that say the same as others get a share of what both say.
class ScaledFactor {
 public:
  explicit ScaledFactor(const Eigen::MatrixXd& products);

  Eigen::VectorXd Solve(const Eigen::VectorXd& right) const;
  Eigen::MatrixXd SolveColumns(const Eigen::MatrixXd& right) const;

 private:
  Eigen::VectorXd scale_;  ///< of each column
  SymmetricFactor factor_;
};

/// Energy of what a regression on the other columns leaves of the last one, from products of all with all.
double EnergyLeft(const Eigen::MatrixXd& products);

/// LL' of a positive definite matrix; its lower triangle is read.
class PositiveFactor {
 public:
  explicit PositiveFactor(const Eigen::MatrixXd& positive);

  bool sound() const { return factor_.info() == Eigen::Success; }
  Eigen::MatrixXd SolveColumns(const Eigen::MatrixXd& right) const;
  Eigen::MatrixXd SolveLower(const Eigen::MatrixXd& right) const;  ///< L^-1 right
  Eigen::VectorXd SolveLower(const Eigen::VectorXd& right) const;
  Eigen::MatrixXd SolveUpper(const Eigen::MatrixXd& right) const;  ///< L'^-1 right

 private:
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

/// By LU with partial pivoting; not finite where `square` is singular.
Eigen::MatrixXd Inverse(const Eigen::MatrixXd& square);
/// Moore and Penrose's, by a complete orthogonal decomposition.
Eigen::MatrixXd PseudoInverse(const Eigen::MatrixXd& any);
/// Columns that span what the columns of `tall` span, as many.
Eigen::MatrixXd OrthonormalBasis(const Eigen::MatrixXd& tall);

}  // namespace hydroscope
