#pragma once

#include <Eigen/Dense>
#include <algorithm>

#include "estimation/gram_fit.h"

namespace hydroscope {

/// Factor on the standard error of a parameter that was found from its changes as pieces of a record are left out in turn, for
/// Student's t. One that few pieces tell of has as many degrees of freedom as the squares of its changes weigh (Satterthwaite
/// 1946, with 3 s^4 for the mean fourth power of what has the variance s^2), at least 2.
inline double StudentOfPieces(const Eigen::VectorXd& changes) {
  constexpr double kFewest = 2;
  const double most = static_cast<double>(changes.size()) - 1, squares = changes.squaredNorm(),
               fourths = changes.cwiseAbs2().squaredNorm();
  if (!(fourths > 0) || most < kFewest) return 1;
  return StudentFactor(std::clamp(3 * squares * squares / fourths, kFewest, most));
}

}  // namespace hydroscope
