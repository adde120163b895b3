#include "simulator/manipulator/manipulator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace hydroscope {
namespace {

using testing::HasSubstr;

ManipulatorState At(double q_1, double q_2, double w_1 = 0, double w_2 = 0) {
  ManipulatorState state;
  state.q = {q_1, q_2};
  state.w = {w_1, w_2};
  return state;
}

/// Potential energy from the centres of mass.
double Potential(const ManipulatorTruth& m, double q_1, double q_2) {
  const LinkTruth &a = m.links[0], &b = m.links[1];
  const double elbow = a.length * std::sin(q_1), both = q_1 + q_2;
  return 9.81 * (a.mass * (a.c_x * std::sin(q_1) + a.c_y * std::cos(q_1)) +
                 b.mass * (elbow + b.c_x * std::sin(both) + b.c_y * std::cos(both)) +
                 m.payload * (elbow + b.length * std::sin(both)));
}

TEST(Manipulator, HoldsItsWeightWithTheSlopeOfThePotential) {
  ManipulatorTruth m = PublishedManipulator();
  m.payload = 60;
  const auto torque = InverseDynamics(m, At(0.4, -1.3), {});
  const double h = 1e-6;
  EXPECT_NEAR(torque[0], (Potential(m, 0.4 + h, -1.3) - Potential(m, 0.4 - h, -1.3)) / (2 * h), 1e-3);
  EXPECT_NEAR(torque[1], (Potential(m, 0.4, -1.3 + h) - Potential(m, 0.4, -1.3 - h)) / (2 * h), 1e-3);
}

TEST(Manipulator, HasASymmetricMassMatrix) {
  const ManipulatorTruth m = PublishedManipulator();
  const ManipulatorState state = At(0.4, -1.3, 0.3, -0.2);
  const auto bias = InverseDynamics(m, state, {});
  EXPECT_NEAR(InverseDynamics(m, state, {1, 0})[1] - bias[1], InverseDynamics(m, state, {0, 1})[0] - bias[0],
              1e-8);
}

TEST(Manipulator, HasTheBaseParametersThatThePaperIdentified) {
  const ControllerModel model = TrueModel(PublishedManipulator());
  const std::array<double, 6> published = {1111.6, -117.3, 2305.2, 1074.2, -73.1, 2458.4};
  for (std::size_t k = 0; k < published.size(); ++k) EXPECT_NEAR(model.rigid[k], published[k], 0.2);
}

TEST(Manipulator, ReachesAlongTheLawOfCosines) {
  const CylinderTruth c = PublishedManipulator().cylinders[0];
  const double h = 1e-6;
  EXPECT_NEAR(ReachOf(c, 0.5).lever, (ReachOf(c, 0.5 + h).x - ReachOf(c, 0.5 - h).x) / (2 * h), 1e-8);
}

TEST(Manipulator, StandsWithItsValvesClosed) {
  ManipulatorPlant plant(PublishedManipulator(), {0.4, -1.3});
  plant.Run({0, 0}, 2);
  EXPECT_NEAR(plant.state().q[0], 0.4, 1e-4);
  EXPECT_NEAR(plant.state().q[1], -1.3, 1e-4);
}

TEST(Manipulator, RisesWhenTheFirstValveOpens) {
  ManipulatorPlant plant(PublishedManipulator(), {0.4, -1.3});
  plant.Run({0.2, 0}, 1);
  EXPECT_GT(plant.state().q[0], 0.45);
}

/// Mean pressure of the piston side of the first cylinder while the arm follows the same motion.
double MeanPressure(const ManipulatorOptions& options) {
  double sum = 0;
  const ManipulatorLog log = SimulateManipulator(options);
  for (const ManipulatorRow& row : log.rows) sum += row.readings.p_1[0] - 0.686 * row.readings.p_2[0];
  return sum / static_cast<double>(log.rows.size());
}

TEST(Manipulator, CarriesAPayloadByPressure) {
  ManipulatorOptions options;
  options.seconds = 10;
  const double empty = MeanPressure(options);
  ASSERT_TRUE(HideEffect("payload=100", options.truth));
  EXPECT_GT(MeanPressure(options), empty + 5e5);
}

TEST(Manipulator, GivesTheSameRowsForTheSameSeed) {
  ManipulatorOptions options;
  options.seconds = 2;
  std::string a, b;
  for (const ManipulatorRow& row : SimulateManipulator(options).rows) AppendManipulatorLine(row, a);
  for (const ManipulatorRow& row : SimulateManipulator(options).rows) AppendManipulatorLine(row, b);
  EXPECT_EQ(a, b);
}

TEST(Manipulator, FollowsThePathBetterWithTheTruthThanWithTheDatasheet) {
  ManipulatorOptions options;
  options.motion = ParallelogramMotion();
  options.seconds = 15;
  const double datasheet = SimulateManipulator(options).tracking.rms;
  options.model = TrueModel(options.truth);
  EXPECT_LT(SimulateManipulator(options).tracking.rms, 0.2 * datasheet);
}

TEST(Manipulator, SaysWhatIsWrongWithAnEffect) {
  ManipulatorTruth m = PublishedManipulator();
  EXPECT_THAT(HideEffect("paylod", m).error().text, HasSubstr("payload"));
  EXPECT_THAT(HideEffect("payload=heavy", m).error().text, HasSubstr("number of kg"));
  EXPECT_THAT(HideEffect("joint_play_2=-1", m).error().text, HasSubstr("0 or more"));
  for (const ManipulatorEffectInfo& e : ManipulatorEffects()) EXPECT_TRUE(HideEffect(e.id, m)) << e.id;
  EXPECT_GT(m.cylinders[1].worn[3], 0);
  EXPECT_GT(m.cylinders[0].F_stribeck, 0);
}

TEST(Manipulator, RefusesASamplePeriodThatIsNoneOfTheControllers) {
  ManipulatorOptions options;
  options.sample_period = 0.003;
  EXPECT_THAT(Validate(options).error().text, HasSubstr("multiple"));
  options.sample_period = 0.004;
  options.seconds = std::nan("");
  EXPECT_FALSE(Validate(options));
}

}  // namespace
}  // namespace hydroscope
