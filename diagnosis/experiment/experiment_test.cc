#include "diagnosis/experiment/experiment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "diagnosis/explain.h"
#include "studies/simulated_strokes.h"

namespace hydroscope {
namespace {

/// A small leak past the piston seal: with chamber B at one pressure it looks the same as one to the outside.
PressOptions SmallLeak() {
  PressOptions press;
  press.seconds = 60;
  press.seed = 31;
  press.effects = {{"internal_leakage", 0.9e-12, {}}};
  return press;
}

class ExperimentTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    strokes_ = new LogStrokes(
        StrokesOf(SimulatePress(SmallLeak()), MachineFor(SmallLeak()), KeepSamples::kYes).value());
    explanation_ = new Explanation(ExplainSamples(strokes_->model, strokes_->stretches, strokes_->window));
  }
  static void TearDownTestSuite() {
    delete strokes_;
    delete explanation_;
  }
  static Machine Allowing(double rod_min, double rod_max) {
    Machine machine = strokes_->machine;
    machine.experiment.settings["rod_pressure"] = {rod_min, rod_max};
    return machine;
  }
  static Experiment Propose(const Machine& machine) {
    return ProposeExperiment(*explanation_, machine, strokes_->stretches, strokes_->window);
  }

  inline static LogStrokes* strokes_ = nullptr;
  inline static Explanation* explanation_ = nullptr;
};

TEST_F(ExperimentTest, TwoLeaksThatOnlyChamberBTellsApartAreAmbiguousBefore) {
  ASSERT_EQ(explanation_->verdict, Verdict::kAmbiguous);
  EXPECT_THAT(explanation_->set, testing::IsSupersetOf({"internal_leakage", "external_leakage"}));
}

TEST_F(ExperimentTest, AsksForTwoPressuresInChamberBWhereTheMachineAllowsThem) {
  const Experiment e = Propose(Allowing(20e5, 60e5));
  EXPECT_EQ(e.Levels("rod_pressure"), (std::vector<double>{20e5, 60e5}));
  EXPECT_GE(e.strokes, 24);
  EXPECT_LT(e.strokes, 100);
  EXPECT_GE(e.separation, 100);
  EXPECT_NE(ExperimentText(e).english.find("20 and 60 bar in chamber B"), std::string::npos)
      << ExperimentText(e).english;
}

TEST_F(ExperimentTest, NeverLeavesTheMovesAllowed) {
  Machine machine = Allowing(60e5, 60e5);
  machine.experiment.settings["ram_speed"] = {0.03, 0.09};
  machine.experiment.settings["pressure"] = {60e5, 150e5};
  machine.experiment.max_strokes = 100000;
  const Experiment e = Propose(machine);
  ASSERT_TRUE(e.proposed());
  EXPECT_TRUE(e.Levels("rod_pressure").empty());
  EXPECT_TRUE(e.Levels("warm_up").empty());
  EXPECT_THAT(e.Levels("ram_speed"), testing::Each(testing::AllOf(testing::Ge(0.03), testing::Le(0.09))));
  EXPECT_THAT(e.Levels("pressure"), testing::Each(testing::AllOf(testing::Ge(60e5), testing::Le(150e5))));
}

TEST_F(ExperimentTest, ProposesNothingThatWouldNotSettleIt) {
  Machine machine = Allowing(60e5, 60e5);
  machine.experiment.settings["ram_speed"] = {0.03, 0.03};
  machine.experiment.settings["pressure"] = {60e5, 60e5};
  machine.experiment.max_strokes = 24;
  const Experiment e = Propose(machine);
  EXPECT_FALSE(e.proposed());
  EXPECT_EQ(e.left, explanation_->set);
}

/// What warms evenly with time is a class with what drifts; in strokes recorded later time has gone on and the oil is cold again.
TEST(ExperimentOfADrift, StrokesRecordedLaterTellItFromTheOil) {
  PressOptions press;
  press.seconds = 60;
  press.oil_start = 300;
  press.oil_end = 312;
  press.effects = {{"oil_viscosity", 0.002, {}}};
  const auto strokes_of = [](const PressOptions& of) {
    return *StrokesOf(SimulatePress(of), MachineFor(of), KeepSamples::kYes);
  };
  LogStrokes log = strokes_of(press);
  const Explanation before = ExplainSamples(log.model, log.stretches, log.window);
  ASSERT_THAT(before.set,
              testing::UnorderedElementsAre("oil_viscosity", "Q_vn_drift", "pressure_gain_drift"));
  const Experiment e = ProposeExperiment(before, log.machine, log.stretches, log.window);
  ASSERT_TRUE(e.proposed());
  EXPECT_THAT(e.left, testing::IsEmpty());
  press.seed += 1;
  press.motion.speeds = e.Levels("ram_speed");
  press.motion.set_points = e.Levels("pressure");
  press.seconds = e.seconds + 3.0 * e.strokes;
  Append(strokes_of(press), log);
  const Explanation after = ExplainSamples(log.model, log.stretches, log.window);
  EXPECT_THAT(after.set, testing::ElementsAre("oil_viscosity"));
}

TEST_F(ExperimentTest, RecordedAndExplainedTogetherItNamesTheLeak) {
  const Experiment e = Propose(Allowing(20e5, 60e5));
  PressOptions press = SmallLeak();
  press.seed += 1;
  press.motion.speeds = e.Levels("ram_speed");
  press.motion.set_points = e.Levels("pressure");
  press.motion.rod_pressures = e.Levels("rod_pressure");
  press.seconds = e.seconds + 3.0 * e.strokes;
  const auto second = StrokesOf(SimulatePress(press), MachineFor(press), KeepSamples::kYes);
  ASSERT_TRUE(second);
  std::vector<StrokeStretches> both = strokes_->stretches;
  both.insert(both.end(), second->stretches.begin(), second->stretches.end());
  const Explanation x = ExplainSamples(strokes_->model, both, strokes_->window);
  EXPECT_EQ(x.verdict, Verdict::kNamed);
  EXPECT_EQ(x.set, (std::vector<std::string>{"internal_leakage"}));
}

}  // namespace
}  // namespace hydroscope
