#include "diagnosis/closed_loop/change.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "machines/test_cylinder/kind.h"
#include "machines/test_cylinder/response.h"

namespace hydroscope {
namespace {

using LoopVerdict = LoopComparison::Verdict;

LoopState Cylinder() {
  LoopState state{{{343, 0.9766, 160, 0.0114, 0}, Eigen::MatrixXd::Zero(5, 5)}, {}};
  const double stds[] = {0.002, 0.003, 0.006, 0.001, 2e-6};
  for (int i = 0; i < 5; ++i) state.covariance(i, i) = stds[i] * stds[i];
  return state;
}

std::vector<std::string_view> Ids(const LoopChangeSet& set) {
  std::vector<std::string_view> ids;
  for (const SizedChange& c : set.changes) ids.push_back(c.change->id);
  return ids;
}

TEST(LoopChange, OfFewBlocksTheErrorsAreAsWideAsTheIntervals) {
  LoopResponse response;
  response.fit.emplace();
  static_cast<LoopEstimate&>(*response.fit) = Cylinder();
  response.fit->blocks = 7;  // two degrees of freedom beyond five parameters: Student's 4.303 for 1.96
  EXPECT_NEAR(std::sqrt(StateOf(response).covariance(0, 0)), 4.303 / 1.96 * 0.002, 1e-5);
}

TEST(LoopChange, ChangesThatShortRecordsWouldNotShowAreTold) {
  EXPECT_TRUE(CompareLoopStates(kTestCylinderPlant, Cylinder(), Cylinder()).unseen.empty());
  LoopState vague = Cylinder();
  vague.covariance *= 50 * 50;
  const LoopComparison c = CompareLoopStates(kTestCylinderPlant, Cylinder(), vague);
  EXPECT_EQ(c.verdict, LoopVerdict::kAdequate);
  ASSERT_FALSE(c.unseen.empty());
  for (const SizedChange& sized : c.unseen) {
    if (sized.change->direction.back() != 0) continue;
    LoopState changed = vague;
    for (std::size_t i = 0; i + 1 < changed.parameters.size(); ++i)
      changed.parameters[i] *= std::exp(0.95 * sized.size * sized.change->direction[i]);
    EXPECT_EQ(CompareLoopStates(kTestCylinderPlant, Cylinder(), changed).verdict, LoopVerdict::kAdequate)
        << sized.change->id;
  }
}

TEST(LoopChange, TheSameCylinderIsAdequateAndSoIsThePublishedDifferenceOfDamping) {
  LoopState after = Cylinder();
  EXPECT_EQ(CompareLoopStates(kTestCylinderPlant, Cylinder(), after).verdict, LoopVerdict::kAdequate);
  after.parameters[1] = 1.0012;
  EXPECT_EQ(CompareLoopStates(kTestCylinderPlant, Cylinder(), after).verdict, LoopVerdict::kAdequate);
}

TEST(LoopChange, AValveOfTwiceTheSizeIsAGainThatDoubledAndNothingElse) {
  LoopState after = Cylinder();
  after.parameters[1] = 1.0012;
  after.parameters[3] = 0.0230;
  const LoopComparison c = CompareLoopStates(kTestCylinderPlant, Cylinder(), after);
  EXPECT_EQ(c.verdict, LoopVerdict::kNamed);
  EXPECT_THAT(Ids(c.set), testing::ElementsAre("valve_gain"));
  EXPECT_NEAR(std::exp(c.set.changes[0].size), 2.018, 0.01);
}

TEST(LoopChange, AirAndASpecimenAreTheirOwnPatternsOverTheFigures) {
  LoopState air = Cylinder();
  air.parameters[0] *= std::sqrt(0.8);
  air.parameters[1] /= std::sqrt(0.8);
  EXPECT_THAT(Ids(CompareLoopStates(kTestCylinderPlant, Cylinder(), air).set),
              testing::ElementsAre("trapped_air"));
  LoopState specimen = Cylinder();
  specimen.parameters[0] *= std::sqrt(1.3);
  specimen.parameters[1] /= std::sqrt(1.3);
  specimen.parameters[3] /= 1.3;
  EXPECT_THAT(Ids(CompareLoopStates(kTestCylinderPlant, Cylinder(), specimen).set),
              testing::ElementsAre("specimen_stiffness"));
}

TEST(LoopChange, TwoChangesThatTogetherLookLikeOneAreToldBesideIt) {
  LoopState after = Cylinder();  // mass and friction a quarter up
  after.parameters[0] /= std::sqrt(1.25);
  after.parameters[1] *= std::sqrt(1.25);
  const LoopComparison c = CompareLoopStates(kTestCylinderPlant, Cylinder(), after);
  EXPECT_THAT(Ids(c.set), testing::ElementsAre("trapped_air"));
  ASSERT_EQ(c.imitators.size(), 1u);
  EXPECT_THAT(Ids(c.imitators.front()), testing::UnorderedElementsAre("friction", "moving_mass"));
  for (const SizedChange& part : c.imitators.front().changes) EXPECT_NEAR(part.size, std::log(1.25), 0.01);
}

TEST(LoopChange, PolesThatAirMadeRealAreSharedOutSoThatTheFewestChangesDo) {
  LoopState air = Cylinder();
  air.parameters[0] *= std::sqrt(0.8);
  air.parameters[1] /= std::sqrt(0.8);
  ASSERT_TRUE(ShareOutPoles(air.parameters, 0));
  EXPECT_GT(air.parameters[2], 300) << "the valve's pole passes for one of the oil column's";
  EXPECT_THAT(Ids(CompareLoopStates(kTestCylinderPlant, Cylinder(), air).set),
              testing::ElementsAre("trapped_air"));
}

TEST(LoopChange, AGainOfTheOtherSignIsAReversedSignalAndNothingIsCompared) {
  LoopState after = Cylinder();
  after.parameters[3] *= -1;
  const LoopComparison c = CompareLoopStates(kTestCylinderPlant, Cylinder(), after);
  EXPECT_TRUE(c.reversed);
  EXPECT_EQ(c.verdict, LoopVerdict::kUnknown);
  EXPECT_TRUE(c.set.changes.empty());
  EXPECT_FALSE(CompareLoopStates(kTestCylinderPlant, after, after).reversed);
}

TEST(LoopChange, ASharpChangeOfTheGainDoesNotDrownInWhatTheOtherFiguresLeave) {
  for (const double factor : {0.95, 1.05}) {
    LoopState after = Cylinder();
    after.parameters[3] *= factor;
    const LoopComparison c = CompareLoopStates(kTestCylinderPlant, Cylinder(), after);
    EXPECT_GT(c.nothing.p_value, 0.01) << "over all figures nothing stands out";
    EXPECT_NE(c.verdict, LoopVerdict::kAdequate) << factor;
    EXPECT_THAT(Ids(c.set), testing::ElementsAre("valve_gain")) << factor;
  }
}

/// Of a cylinder that friction alone damped, as its physical constants have it (the paper's eq. 9).
LoopState WithLeakage(double leakage) {
  const double area = 1300.6e-6, volume = 167523e-9, mass = 6.07;
  LoopState state = Cylinder();
  double &f_h = state.parameters[0], &zeta_h = state.parameters[1];
  const double w = kTwoPi * f_h, friction = 2 * zeta_h * w * mass;
  const double spring =
      volume / (4 * area * area) * (4 * area * area / (volume * mass * w * w));  // V/(4 K A^2)
  const double a = mass * spring, b = friction * spring + mass * leakage / (area * area);
  const double c = 1 + friction * leakage / (area * area);
  f_h = std::sqrt(c / a) / kTwoPi;
  zeta_h = b / (2 * std::sqrt(a * c));
  state.parameters[3] /= c;
  return state;
}

TEST(LoopChange, LeakageAcrossThePistonIsNamedAndNoSpecimen) {
  const LoopComparison c = CompareLoopStates(kTestCylinderPlant, Cylinder(), WithLeakage(32e-12));
  EXPECT_EQ(c.verdict, LoopVerdict::kNamed);
  ASSERT_THAT(Ids(c.set), testing::ElementsAre("piston_leakage"));
  EXPECT_NEAR(std::exp(c.set.changes[0].size), 0.0114 / WithLeakage(32e-12).parameters[3], 1e-3);
  EXPECT_LT(c.set.chi_squared, 1e-6) << "the curve and not its beginning";
  ASSERT_FALSE(c.imitators.empty());
  EXPECT_THAT(Ids(c.imitators.front()), testing::UnorderedElementsAre("friction", "specimen_stiffness"));
}

TEST(LoopChange, LittleLeakageIsNotToldFromASpecimen) {
  const LoopComparison c = CompareLoopStates(kTestCylinderPlant, Cylinder(), WithLeakage(8e-12));
  EXPECT_EQ(c.verdict, LoopVerdict::kAmbiguous);
  std::vector<std::string_view> all = Ids(c.set);
  for (const LoopChangeSet& other : c.others)
    for (const std::string_view id : Ids(other)) all.push_back(id);
  EXPECT_THAT(all, testing::IsSupersetOf({"piston_leakage", "specimen_stiffness"}));
}

TEST(LoopChange, PolesThatMayBeOneAreSharedOutToo) {
  LoopState worn =
      Cylinder();  // friction 40 % up: poles at 149 Hz and 160 Hz, which a record takes for a double one
  worn.parameters = {154.4, 0.9999, 796, 0.0114, 0};
  worn.covariance.diagonal() << 9e-6, 9.7e-6, 1.2e-3, 1.6e-6, 1.4e-11;
  const LoopComparison c = CompareLoopStates(kTestCylinderPlant, Cylinder(), worn);
  EXPECT_EQ(c.verdict, LoopVerdict::kNamed);
  EXPECT_THAT(Ids(c.set), testing::ElementsAre("friction"));
  const LoopEstimate meant = NearestWay(kTestCylinderPlant, worn, Cylinder().parameters);
  EXPECT_NEAR(meant.parameters[0], 350, 1);
  EXPECT_NEAR(meant.parameters[2], 160, 2 * meant.Std(kTestCylinderPlant.parameters[2], 2));
  EXPECT_GT(meant.Std(kTestCylinderPlant.parameters[2], 2), 0.03 * 160) << "over both of the pair";
  worn.parameters[1] = 0.9;  // surely a pair that swings
  EXPECT_EQ(NearestWay(kTestCylinderPlant, worn, Cylinder().parameters).parameters[0], 154.4);
}

TEST(LoopChange, OfPolesThatAreNotToldApartNothingIsConcluded) {
  LoopState brief = Cylinder();  // the same cylinder in few seconds, which tell of a double pole and another
  brief.parameters = {204.9, 0.999, 509, 0.01133, 2e-5};
  brief.covariance.diagonal() << 0.3, 0.04, 1.9, 3e-5, 1e-10;
  LoopComparison c = CompareLoopStates(kTestCylinderPlant, Cylinder(), brief);
  EXPECT_TRUE(c.poles_unknown);
  EXPECT_EQ(c.verdict, LoopVerdict::kUnknown);
  EXPECT_TRUE(c.set.changes.empty());
  brief.parameters[3] *= 0.5;
  c = CompareLoopStates(kTestCylinderPlant, Cylinder(), brief);
  EXPECT_EQ(c.verdict, LoopVerdict::kAmbiguous) << "the gain did change";
  EXPECT_FALSE(CompareLoopStates(kTestCylinderPlant, Cylinder(), Cylinder()).poles_unknown);
}

TEST(LoopChange, TwoChangesAtOnceAreBothNamed) {
  LoopState after = Cylinder();
  after.parameters[3] *= 2;
  after.parameters[4] = 1e-4;
  EXPECT_THAT(Ids(CompareLoopStates(kTestCylinderPlant, Cylinder(), after).set),
              testing::UnorderedElementsAre("valve_gain", "sensor_delay"));
}

TEST(LoopChange, WhatNoThreeChangesExplainIsUnknown) {
  LoopState after = Cylinder();
  const double factors[] = {1.3, 0.7, 1.4, 0.6};
  for (std::size_t i = 0; i < 4; ++i) after.parameters[i] *= factors[i];
  after.parameters[4] = 3e-4;
  EXPECT_EQ(CompareLoopStates(kTestCylinderPlant, Cylinder(), after).verdict, LoopVerdict::kUnknown);
}

TEST(LoopChange, ASaturationThatAppearedIsNamedByItself) {
  LoopState after = Cylinder();
  after.input_limit = 0.012;
  const LoopComparison c = CompareLoopStates(kTestCylinderPlant, Cylinder(), after);
  EXPECT_EQ(c.verdict, LoopVerdict::kNamed);
  EXPECT_TRUE(c.limit_appeared);
  EXPECT_TRUE(c.set.changes.empty());
}

TEST(LoopChange, NothingIsNamedWhereFiguresGoWithTheExcitation) {
  LoopState after = Cylinder();
  after.parameters[3] *= 0.66;
  EXPECT_EQ(CompareLoopStates(kTestCylinderPlant, Cylinder(), after).verdict, LoopVerdict::kNamed);
  after.dead_band = 0.002;
  const LoopComparison c = CompareLoopStates(kTestCylinderPlant, Cylinder(), after);
  EXPECT_EQ(c.verdict, LoopVerdict::kUnknown);
  EXPECT_TRUE(c.dead_band);
  LoopState before = Cylinder();
  before.dead_band = 0.002;
  EXPECT_EQ(CompareLoopStates(kTestCylinderPlant, before, after).verdict, LoopVerdict::kNamed)
      << "both have it";
}

TEST(LoopChange, AGainThatReadingsWhichEndMayMakeIsNotNamed) {
  LoopState after = Cylinder();
  after.readings_end = 0.015;
  EXPECT_EQ(CompareLoopStates(kTestCylinderPlant, Cylinder(), after).verdict, LoopVerdict::kAdequate);
  after.parameters[3] *= 1.065;
  const LoopComparison c = CompareLoopStates(kTestCylinderPlant, Cylinder(), after);
  EXPECT_EQ(c.verdict, LoopVerdict::kUnknown);
  EXPECT_TRUE(c.readings_end);
}

TEST(LoopChange, ReferencesWithoutErrorsAreComparedToo) {
  LoopState reference = Cylinder();
  reference.covariance.setZero();
  LoopState after = Cylinder();
  after.parameters[2] *= 0.8;
  EXPECT_THAT(Ids(CompareLoopStates(kTestCylinderPlant, reference, after).set),
              testing::ElementsAre("slow_valve"));
}

}  // namespace
}  // namespace hydroscope
