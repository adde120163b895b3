#include "estimation/closed_loop/loop_estimate.h"

#include <algorithm>
#include <cmath>

#include "core/non_negative.h"

namespace hydroscope {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ParameterKind = LoopParameter::Kind;

// Standard deviation of a parameter's logarithm above which its pole is not told from others.
constexpr double kKnownOneByOne = 0.3;
// Standard deviations of a damping's logarithm within which a pair of poles may be a double one.
constexpr double kMayBeDouble = 3;
constexpr double kStepOfSharing = 1e-5;  // of a logarithm: slopes are good to 1e-9

using SharedParameters = std::optional<std::vector<double>>;

SharedParameters InWay(const ClosedLoopPlant& plant, std::vector<double> parameters, int way) {
  if (!plant.share_out(parameters, way)) return std::nullopt;
  return parameters;
}

/// Slopes of the logarithms of the positive parameters, shared out, by those before; without `held`, which stays as it is.
std::optional<MatrixXd> SlopesOfWay(const ClosedLoopPlant& plant, const std::vector<double>& parameters,
                                    int way, std::ptrdiff_t held) {
  const auto count = static_cast<std::ptrdiff_t>(parameters.size());
  MatrixXd slopes = MatrixXd::Identity(count, count);
  for (std::ptrdiff_t j = 0; j < count; ++j) {
    if (j == held) slopes.col(j).setZero();
    if (j == held || plant.parameters[j].kind != ParameterKind::kPositive) continue;
    std::vector<double> raised = parameters, lowered = parameters;
    raised[j] *= 1 + kStepOfSharing;
    lowered[j] *= 1 - kStepOfSharing;
    const SharedParameters up = InWay(plant, raised, way), down = InWay(plant, lowered, way);
    if (!up || !down) return std::nullopt;
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (plant.parameters[at].kind == ParameterKind::kPositive)
        slopes(i, j) = std::log((*up)[at] / (*down)[at]) / (2 * kStepOfSharing);
    }
  }
  return slopes;
}

/// With the logarithm of the damping at `log_damping` and the others where the covariance has them then.
std::vector<double> WithDamping(const ClosedLoopPlant& plant, const LoopEstimate& estimate,
                                double log_damping) {
  std::vector<double> parameters = estimate.parameters;
  const auto d = static_cast<std::ptrdiff_t>(plant.damping);
  const double by = (log_damping - std::log(parameters[d])) / estimate.covariance(d, d);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double step = by * estimate.covariance(static_cast<std::ptrdiff_t>(i), d);
    if (plant.parameters[i].kind == ParameterKind::kDelay)
      parameters[i] += step;
    else
      parameters[i] *= std::exp(step);
  }
  parameters[d] = std::exp(log_damping);
  return parameters;
}

/// Of a pair of poles that may be double within their errors: the double one shared out, and errors that reach over both of the
/// pair, as far as they may lie apart.
std::optional<LoopEstimate> SharedOutFromDouble(const ClosedLoopPlant& plant, const LoopEstimate& estimate,
                                                int way) {
  if (plant.damping < 0 || way == 0) return std::nullopt;
  const auto d = static_cast<std::ptrdiff_t>(plant.damping);
  const double log_damping = std::log(estimate.parameters[d]), variance = estimate.covariance(d, d);
  if (!(variance > 0) || log_damping * log_damping > kMayBeDouble * kMayBeDouble * variance)
    return std::nullopt;
  const std::vector<double> met = WithDamping(plant, estimate, 0);
  const auto centre = InWay(plant, met, way);
  const auto apart =
      InWay(plant, WithDamping(plant, estimate, std::max(0.0, log_damping) + std::sqrt(variance)), way);
  const auto slopes = SlopesOfWay(plant, met, way, d);
  if (!centre || !apart || !slopes) return std::nullopt;
  const VectorXd with_damping = estimate.covariance.col(d) / std::sqrt(variance);
  LoopEstimate other{*centre, *slopes * (estimate.covariance - with_damping * with_damping.transpose()) *
                                  slopes->transpose()};
  VectorXd reach = with_damping;  // of gain and delay
  for (std::size_t i = 0; i < met.size(); ++i)
    if (plant.parameters[i].kind == ParameterKind::kPositive)
      reach(static_cast<std::ptrdiff_t>(i)) = std::log((*apart)[i] / (*centre)[i]);
  other.covariance += reach * reach.transpose();
  return other;
}

}  // namespace

double LoopEstimate::Std(const LoopParameter& parameter, std::size_t index) const {
  const auto i = static_cast<std::ptrdiff_t>(index);
  const double std = std::sqrt(NonNegative(covariance(i, i)));
  return parameter.kind == ParameterKind::kDelay ? std : std * std::abs(parameters[index]);
}

bool KnownOneByOne(const ClosedLoopPlant& plant, const LoopEstimate& estimate) {
  for (std::ptrdiff_t i = 0; i < estimate.covariance.rows(); ++i)
    if (plant.parameters[i].kind == ParameterKind::kPositive &&
        !(std::sqrt(estimate.covariance(i, i)) <= kKnownOneByOne))
      return false;
  return true;
}

std::optional<LoopEstimate> SharedOut(const ClosedLoopPlant& plant, const LoopEstimate& estimate, int way) {
  if (plant.share_out == nullptr) return std::nullopt;
  const auto shared = InWay(plant, estimate.parameters, way);
  const auto slopes = SlopesOfWay(plant, estimate.parameters, way, -1);
  if (shared && slopes) {
    LoopEstimate other{*shared, *slopes * estimate.covariance * slopes->transpose()};
    if (KnownOneByOne(plant, other)) return other;
  }
  return SharedOutFromDouble(plant, estimate, way);
}

LoopEstimate NearestWay(const ClosedLoopPlant& plant, const LoopEstimate& estimate,
                        const std::vector<double>& known) {
  const auto distance = [&](const LoopEstimate& e) {
    double sum = 0;
    for (std::size_t i = 0; i < e.parameters.size(); ++i)
      if (plant.parameters[i].kind == ParameterKind::kPositive && known[i] > 0)
        sum += std::pow(std::log(e.parameters[i] / known[i]), 2);
    return sum;
  };
  LoopEstimate nearest = estimate;
  for (int way = 0; way < plant.ways; ++way)
    if (const auto other = SharedOut(plant, estimate, way); other && distance(*other) < distance(nearest))
      nearest = *other;
  return nearest;
}

}  // namespace hydroscope
