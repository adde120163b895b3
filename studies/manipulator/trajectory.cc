#include "estimation/linear_form/trajectory.h"

#include <fmt/format.h>

#include <cmath>

#include "studies/manipulator/benchmark.h"
#include "studies/manipulator/identification.h"

namespace hydroscope {
namespace {

constexpr int kDrawn = 5;
constexpr int kRigidParameters = 6;

ManipulatorMotion MotionOf(const Trajectory& trajectory) {
  ManipulatorMotion motion;
  motion.base_frequency = 1 / trajectory.period;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const SignalSeries& signal = trajectory.signals[i];
    motion.series[i].centre = signal.centre;
    for (std::size_t k = 0; k < signal.sine.size(); ++k)
      motion.series[i].terms.push_back({signal.sine[k], signal.cosine[k]});
  }
  return motion;
}

/// Geometric mean of the relative standard deviations of the rigid bodies' parameters.
double IntervalWidth(const LinearFit& fit) {
  double sum = 0;
  for (Eigen::Index k = 0; k < kRigidParameters; ++k) sum += std::log(fit.std[k] / std::abs(fit.value[k]));
  return std::exp(sum / kRigidParameters);
}

}  // namespace

bool PrintTrajectories(const ManipulatorBenchmarkOptions& options) {
  const ManipulatorTruth truth = PublishedManipulator();
  const Machine machine = ManipulatorMachine(truth);
  const auto designed = DesignTrajectory(LinearFormOf(machine), machine,
                                         {{"q_1", -0.15, 0.85, 0.5, 1}, {"q_2", -2.2, -1, 0.5, 1}});
  if (!designed) return false;
  fmt::print("\ntrajectory      condition  mean std of rigid bodies\n");
  double drawn = 0;
  for (int k = 0; k < kDrawn; ++k) {
    const std::uint64_t seed = options.seed * 1000 + k;
    const LinearFit fit = Identify(truth, DrawnMotion(seed), options.seconds, seed).fit;
    if (!fit.solved()) return false;
    drawn += IntervalWidth(fit) / kDrawn;
    fmt::print("drawn {}         {:>8.1f}  {:.3f} %\n", k, fit.base.condition, 100 * IntervalWidth(fit));
  }
  const LinearFit fit = Identify(truth, MotionOf(*designed), options.seconds, options.seed).fit;
  if (!fit.solved()) return false;
  fmt::print(
      "designed        {:>8.1f}  {:.3f} %   (torque balances alone: condition {:.1f}, first draw {:.1f})\n",
      fit.base.condition, 100 * IntervalWidth(fit), designed->condition, designed->first_condition);
  return IntervalWidth(fit) < drawn;
}

}  // namespace hydroscope
