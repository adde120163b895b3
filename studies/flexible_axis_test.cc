#include "studies/flexible_axis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/told_error.h"

namespace hydroscope {
namespace {

StateFit FitOf(AxisManoeuvre manoeuvre, const FlexibleAxisMachine& machine, std::uint64_t start, int starts,
               std::uint64_t noise = 1) {
  FlexibleAxisOptions o;
  o.machine = machine;
  o.manoeuvre = manoeuvre;
  o.seed = noise;
  const Episode episode = FlexibleAxisEpisode(SimulateFlexibleAxis(o));
  const auto model = BuildStateModel(FlexibleAxisFile(), {});
  StateFit none;
  if (!model) none.failed = ToldOf(model.error());
  if (!model) return none;
  StateFitOptions options;
  options.starts = starts;
  return FitStates(StartedWithinTen(**model, FlexibleAxisParameters(machine), start), std::span(&episode, 1),
                   options);
}

TEST(FlexibleAxisStudy, TheStaircaseTellsAllFifteenParameters) {
  const FlexibleAxisMachine machine;
  const StateFit fit = FitOf(AxisManoeuvre::kStaircase, machine, 7, 4);
  ASSERT_TRUE(fit.solved()) << fit.failed.english;
  const Eigen::VectorXd truth = FlexibleAxisParameters(machine);
  for (Eigen::Index p = 0; p < truth.size(); ++p) {
    const double deviation = std::sqrt(fit.covariance(p, p));
    EXPECT_LT(deviation, 0.1 * truth[p]) << fit.model->parameters[static_cast<std::size_t>(p)].name;
    EXPECT_NEAR(fit.parameters[p], truth[p], 4.5 * deviation + 1e-4 * truth[p])
        << fit.model->parameters[static_cast<std::size_t>(p)].name;
  }
  EXPECT_TRUE(fit.unseen.empty());
}

TEST(FlexibleAxisStudy, OneStartFindsAxesWithStiffBristles) {
  for (const std::uint64_t seed : {5, 15, 5513}) {
    const StateFit fit = FitOf(AxisManoeuvre::kStaircase, RandomFlexibleAxis(seed), seed, 0, seed);
    ASSERT_TRUE(fit.solved()) << fit.failed.english;
    const auto readings = static_cast<double>(5 * fit.residuals.front().rows());
    EXPECT_LT(ChiSquare(fit, {}), 1.03 * readings) << "axis " << seed;
  }
}

TEST(FlexibleAxisStudy, AStepLeavesParametersUnseenAndSaysWhich) {
  const FlexibleAxisMachine machine;
  const StateFit fit = FitOf(AxisManoeuvre::kStep, machine, 7, 4);
  ASSERT_TRUE(fit.solved()) << fit.failed.english;
  ASSERT_FALSE(fit.unseen.empty());
  bool bends = false;
  for (const UnseenDirection& unseen : fit.unseen)
    for (const auto& [name, share] : unseen.parts) bends = bends || name == "p_0";
  EXPECT_TRUE(bends) << "how the bulk modulus bends over pressure";
}

TEST(FlexibleAxisStudy, EachEffectIsFoundAtItsSize) {
  const FlexibleAxisMachine machine;
  const Eigen::VectorXd truth = FlexibleAxisParameters(machine);
  const AxisSensors noise;
  const Eigen::VectorXd weights{
      {noise.position, noise.position, noise.acceleration, noise.pressure, noise.pressure}};
  for (const FlexibleAxisFault& fault : AllFlexibleAxisFaults()) {
    FlexibleAxisOptions o;
    o.manoeuvre = AxisManoeuvre::kStaircase;
    o.faults.*fault.size = fault.typical;
    const Episode episode = FlexibleAxisEpisode(SimulateFlexibleAxis(o));
    const auto model = BuildStateModel(FlexibleAxisFile(), {fault.id});
    ASSERT_TRUE(model) << fault.id;
    StateStart start;
    start.parameters = truth;
    start.parameters.conservativeResize((*model)->parameter_count());
    for (Eigen::Index p = truth.size(); p < start.parameters.size(); ++p)
      start.parameters[p] = (*model)->parameters[static_cast<std::size_t>(p)].spec.start;
    const StateFit fit = RefitStates(*model, std::span(&episode, 1), std::span(&start, 1), weights);
    ASSERT_TRUE(fit.solved()) << fault.id << ": " << fit.failed.english;
    EXPECT_LT(ChiSquare(fit, noise), 1.05 * 5 * episode.rows()) << fault.id;
    const Eigen::Index effect = truth.size();
    const double size = fit.parameters[effect], deviation = std::sqrt(fit.covariance(effect, effect));
    EXPECT_NEAR(size, fault.typical, 4.5 * deviation + 0.01 * fault.typical) << fault.id;
    // Its square is the chi square that nothing else in the model could make up for.
    EXPECT_GT(size / deviation, 10) << fault.id;
  }
}

}  // namespace
}  // namespace hydroscope
