#include "diagnosis/closed_loop/change.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "machines/test_cylinder/kind.h"
#include "machines/test_cylinder/response.h"

namespace hydroscope {
namespace {

using LoopVerdict = LoopComparison::Verdict;

LoopState Cylinder() {
  LoopState state{{{343, 0.9766, 160, 0.0114, 0}, Eigen::MatrixXd::Zero(5, 5)}, std::nullopt};
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
