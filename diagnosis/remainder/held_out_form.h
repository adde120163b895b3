#pragma once

#include <Eigen/Dense>
#include <vector>

#include "core/parallel/eight_lanes.h"

namespace hydroscope {

/// Normal equations of groups of rows.
struct GroupEquations {
  std::vector<Eigen::MatrixXd> h;  ///< unknowns x unknowns, per group
  Eigen::MatrixXd q;               ///< unknowns x groups
  Eigen::VectorXd energy;          ///< of the right-hand side, per group
};

/// Error energy on groups left out in turn, with the right-hand side of group u times the sign e_u: e' form e, a form for each column
/// of `ridges`. That is added to the diagonal of the sum of all groups and makes what is left without any one group positive definite.
/// The fit without group s is sum_u e_u c_u, so the error on it is a quadratic form in the signs.
std::vector<Eigen::MatrixXd> HeldOutForms(const GroupEquations& groups, const Eigen::MatrixXd& ridges);

/// Choices of signs of the groups.
class SignChoices {
 public:
  /// `signs`: groups x choices.
  explicit SignChoices(const Eigen::MatrixXd& signs);
  /// e' form e of each choice e; `form` is symmetric.
  Eigen::VectorXd Energies(const Eigen::MatrixXd& form) const;

 private:
  Eigen::Index groups_, choices_;
  std::vector<EightLanes> signs_;  ///< some choices side by side; by groups, and so for the next ones
};

}  // namespace hydroscope
