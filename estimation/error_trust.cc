#include "estimation/error_trust.h"

#include <cmath>

#include "core/non_negative.h"
#include "estimation/gram_fit.h"

namespace hydroscope {

std::vector<bool> CarriedByError(const Eigen::MatrixXd& integral, const NormalEquations& flow,
                                 const Eigen::VectorXd& theta, double rms_holdout, double noise_floor,
                                 const ErrorTrustOptions& options) {
  std::vector<bool> carried(static_cast<std::size_t>(theta.size()), false);
  if (!(rms_holdout > options.far * noise_floor) || !(flow.equations > 0)) return carried;
  const double error = std::sqrt(rms_holdout * rms_holdout - noise_floor * noise_floor);
  const double missing = error / std::sqrt(options.alike);
  const Eigen::VectorXd excitation = Excitation(integral), own = Excitation(flow.h);
  for (Eigen::Index i = 0; i < theta.size(); ++i) {
    if (excitation[i] >= options.alike) continue;
    const double alone = std::abs(theta[i]) * std::sqrt(NonNegative(own[i] * flow.h(i, i) / flow.equations));
    carried[static_cast<std::size_t>(i)] = missing > options.useful * alone;
  }
  return carried;
}

}  // namespace hydroscope
