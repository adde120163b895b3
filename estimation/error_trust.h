#pragma once

#include <Eigen/Dense>
#include <vector>

#include "estimation/normal_equations.h"

namespace hydroscope {

struct ErrorTrustOptions {
  /// Share of a column that the others do not explain (Excitation), below which it is all but one of them; a law that is
  /// missing may then be as much like it, and leave this share of its energy.
  double alike = 0.01;
  double far = 2;  ///< times the noise floor: error from which something is missing for sure
  /// Share of the value by which that may move it, as in TrustOf.
  double useful = 0.3;
};

/// Which regression parameters a structured error of the size left could be taken for: their columns are all but explained by
/// the others (`integral`: normal matrix of the fit), the error on strokes left out is far above the noise, and the law that
/// leaves it, were it as much like the column as others are, would move the value by more than is useful. `flow`: equations
/// in whose unit the errors are.
std::vector<bool> CarriedByError(const Eigen::MatrixXd& integral, const NormalEquations& flow,
                                 const Eigen::VectorXd& theta, double rms_holdout, double noise_floor,
                                 const ErrorTrustOptions& options = {});

}  // namespace hydroscope
