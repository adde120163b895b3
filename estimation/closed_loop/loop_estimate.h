#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <optional>
#include <vector>

#include "models/closed_loop.h"

namespace hydroscope {

/// Parameters with what is known of their errors.
struct LoopEstimate {
  std::vector<double> parameters;  ///< SI, as ClosedLoopPlant::parameters
  /// Of the logarithms of positive parameters and of the gain's magnitude, of a delay itself.
  Eigen::MatrixXd covariance;

  /// Of a parameter, SI.
  double Std(const LoopParameter& parameter, std::size_t index) const;
};

/// Whether every positive parameter is known so well that its pole is told from others. Beyond, a response is not that of its
/// parameters alone, and their errors are none that slopes give.
bool KnownOneByOne(const ClosedLoopPlant& plant, const LoopEstimate& estimate);
/// The same response with its poles shared out in another way (ClosedLoopPlant::share_out); nothing if there is no such way, or
/// poles lie so close together that they are not known one by one. A pair that may be a double pole within its error
/// (ClosedLoopPlant::damping) is shared out as one; the errors reach over both, and may be larger than KnownOneByOne has them.
std::optional<LoopEstimate> SharedOut(const ClosedLoopPlant& plant, const LoopEstimate& estimate, int way);
/// Of all ways the one nearest to `known` (SI; NaN: not known), in logarithms.
LoopEstimate NearestWay(const ClosedLoopPlant& plant, const LoopEstimate& estimate,
                        const std::vector<double>& known);

}  // namespace hydroscope
