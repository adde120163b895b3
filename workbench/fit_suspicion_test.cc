#include "workbench/fit_suspicion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "pipeline/geometry_tolerance.h"
#include "simulator/die_cushion/press.h"
#include "studies/simulated_strokes.h"
#include "workbench/fit_output.h"

namespace hydroscope {
namespace {

PressOptions Press() {
  PressOptions options;
  options.seconds = 90;
  options.oil_end = options.oil_start + 10;
  return options;
}
FitSuspicion SuspicionFor(const PressOptions& options) {
  return SuspicionOf(
      ExplainStrokes(*StrokesOf(SimulatePress(options), MachineFor(options), KeepSamples::kYes)));
}

TEST(FitSuspicion, AHealthyLogIsNotSuspected) {
  const FitSuspicion suspicion = SuspicionFor(Press());
  EXPECT_EQ(suspicion.verdict, "adequate");
  EXPECT_TRUE(suspicion.suspects.empty());
  EXPECT_FALSE(suspicion.suspected);
  EXPECT_TRUE(suspicion.warnings.empty()) << suspicion.warnings.front().english;
}

TEST(FitSuspicion, AMissingEffectIsNamed) {
  PressOptions options = Press();
  options.effects = {{"internal_leakage", 4e-12, {}}};
  const FitSuspicion suspicion = SuspicionFor(options);
  ASSERT_FALSE(suspicion.suspects.empty());
  EXPECT_EQ(suspicion.suspects.front(), "internal_leakage");
  ASSERT_FALSE(suspicion.warnings.empty());
  EXPECT_NE(suspicion.warnings.back().english.find("internal_leakage"), std::string::npos);
  EXPECT_NE(suspicion.warnings.back().english.find("absorb"), std::string::npos);
  EXPECT_EQ(suspicion.warnings.back().german.rfind("dem Modell fehlt Innere Leckage", 0), 0u)
      << suspicion.warnings.back().german;
}

// The error stays within 15 % of the noise floor, while V0 is off by several percent.
TEST(FitSuspicion, SignalsThatAreLateAreSaid) {
  PressOptions options = Press();
  options.imperfections = {{"one_signal_early", 0.002, {}, "z"}};
  EXPECT_TRUE(SuspicionFor(options).suspected);
}

// "This is so in strokes 1, 5 alone" needs to know what.
TEST(FitSuspicion, WhatIsMissingIsSaidBeforeWhereItIs) {
  PressOptions options;
  options.seconds = 90;
  options.imperfections = {{"intermittent_leakage", 8e-12, {{"share", 0.2}}, ""}};
  const FitSuspicion suspicion = SuspicionFor(options);
  ASSERT_GE(suspicion.warnings.size(), 2u);
  EXPECT_NE(suspicion.warnings[suspicion.warnings.size() - 2].english.find("the model misses"),
            std::string::npos);
  EXPECT_NE(suspicion.warnings.back().english.find("this is so in strokes"), std::string::npos);
}

TEST(FitSuspicion, TooFewStrokesAreNotJudged) {
  PressOptions options = Press();
  options.seconds = 8;
  const FitSuspicion suspicion = SuspicionFor(options);
  EXPECT_EQ(suspicion.verdict, "");
  EXPECT_TRUE(suspicion.suspected);
  ASSERT_EQ(suspicion.warnings.size(), 1u);
  EXPECT_NE(suspicion.warnings[0].english.find("not judged"), std::string::npos);
}

TEST(AssumeTolerances, AnAreaWithoutOneGetsHalfAPercentAndAStatedOneStays) {
  Machine machine = MachineFor(Press());
  const auto assumed = AssumeTolerances(machine);
  ASSERT_EQ(assumed.size(), 1u);
  EXPECT_EQ(assumed[0].name, "A_A");
  EXPECT_DOUBLE_EQ(machine.geometry["A_A"].std, 0.005 * 0.0125);
  EXPECT_NE(AssumedText(assumed[0]).find("0.5 %"), std::string::npos);
  machine.geometry["A_A"].std = 1e-5;
  EXPECT_TRUE(AssumeTolerances(machine).empty());
  EXPECT_EQ(machine.geometry["A_A"].std, 1e-5);
}

TEST(AssumeTolerances, WidenTheIntervalsOfVolumeAndFlowInAFit) {
  const PressOptions options = Press();
  const SimulatedLog log = SimulatePress(options);
  Machine exact = MachineFor(options), assumed = exact;
  AssumeTolerances(assumed);
  const auto fit_exact = StrokesOf(log, exact), fit_assumed = StrokesOf(log, assumed);
  const auto a = FitBaseModel(*fit_exact->model, fit_exact->Grams(), fit_exact->window);
  const auto b = FitBaseModel(*fit_assumed->model, fit_assumed->Grams(), fit_assumed->window);
  const auto wider = [&](int k, double by) {
    EXPECT_NEAR(b->parameters[k].std, std::hypot(a->parameters[k].std, by), 1e-3 * b->parameters[k].std);
  };
  wider(0, 0);                                         // K
  wider(1, 0.005 * std::abs(a->parameters[1].value));  // V0
  wider(2, 0.005 * a->parameters[2].value);            // Q_vn
  wider(3, 0);                                         // y_0
}

}  // namespace
}  // namespace hydroscope
