#include "diagnosis/experiment/experiment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "diagnosis/explain.h"
#include "diagnosis/simulated_log_fixture.h"

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

Explanation Explain(const SimulatedStrokes& log) {
  return ExplainSamples(log.model, log.strokes, log.window);
}

/// The strokes of a log recorded after `all`.
void Add(SimulatedStrokes next, SimulatedStrokes& all) {
  const Stretch& last = all.strokes.back().back();
  for (StrokeStretches& stretches : next.strokes) {
    for (Stretch& stretch : stretches) {
      stretch.log = 1;
      stretch.begin += last.begin + last.samples * last.period;
    }
    all.strokes.push_back(std::move(stretches));
  }
}

class ExperimentTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    strokes_ = new SimulatedStrokes(StrokesOfPress(SmallLeak()));
    explanation_ = new Explanation(Explain(*strokes_));
  }
  static void TearDownTestSuite() {
    delete strokes_;
    delete explanation_;
  }
  static Machine Allowing(double rod_min, double rod_max) {
    Machine machine = MachineOf(SmallLeak());
    machine.experiment.settings["rod_pressure"] = {rod_min, rod_max};
    return machine;
  }
  static Experiment Propose(const Machine& machine) {
    return ProposeExperiment(*explanation_, machine, strokes_->strokes, strokes_->window);
  }

  inline static SimulatedStrokes* strokes_ = nullptr;
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
  SimulatedStrokes log = StrokesOfPress(press);
  const Explanation before = Explain(log);
  ASSERT_THAT(before.set,
              testing::UnorderedElementsAre("oil_viscosity", "Q_vn_drift", "pressure_gain_drift"));
  const Experiment e = ProposeExperiment(before, MachineOf(press), log.strokes, log.window);
  ASSERT_TRUE(e.proposed());
  EXPECT_THAT(e.left, testing::IsEmpty());
  press.seed += 1;
  press.motion.speeds = e.Levels("ram_speed");
  press.motion.set_points = e.Levels("pressure");
  press.seconds = e.seconds + 3.0 * e.strokes;
  Add(StrokesOfPress(press), log);
  EXPECT_THAT(Explain(log).set, testing::ElementsAre("oil_viscosity"));
}

TEST_F(ExperimentTest, RecordedAndExplainedTogetherItNamesTheLeak) {
  const Experiment e = Propose(Allowing(20e5, 60e5));
  PressOptions press = SmallLeak();
  press.seed += 1;
  press.motion.speeds = e.Levels("ram_speed");
  press.motion.set_points = e.Levels("pressure");
  press.motion.rod_pressures = e.Levels("rod_pressure");
  press.seconds = e.seconds + 3.0 * e.strokes;
  SimulatedStrokes both = *strokes_;
  Add(StrokesOfPress(press), both);
  const Explanation x = Explain(both);
  EXPECT_EQ(x.verdict, Verdict::kNamed);
  EXPECT_EQ(x.set, (std::vector<std::string>{"internal_leakage"}));
}

}  // namespace
}  // namespace hydroscope
