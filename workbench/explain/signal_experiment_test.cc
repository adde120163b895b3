#include "diagnosis/experiment/signal_experiment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "studies/simulated_strokes.h"
#include "workbench/explain/explain_output.h"
#include "workbench/explain/own_machine_fixture.h"
#include "workbench/explain/what_to_record.h"

namespace hydroscope {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;

/// The seal's machine file with more sections at its end and strokes faster than `slowest`, in mm/s.
std::string SealMachineWith(const std::string& sections, const std::string& slowest = "3") {
  std::ifstream file(kSealMachine);
  std::ostringstream all;
  all << file.rdbuf() << "\n" << sections << "\n";
  std::string text = all.str();
  const std::string gate = "{ min = 3, unit";
  text.replace(text.find(gate), gate.size(), "{ min = " + slowest + ", unit");
  const std::string path = testing::TempDir() + "seal_that_may_" + std::to_string(getpid()) + ".toml";
  std::ofstream(path) << text;
  return path;
}

/// Runs at one pressure: friction of constant size and friction in proportion to the pressure look the same.
Seal OnePressure() { return {.coulomb = 5.0, .seed = 21, .pressures = {3.5, 3.505, 3.51}}; }

ExplainResult Explain(const std::vector<std::string>& logs, const std::string& machine) {
  auto result = ExplainLogs(logs, machine);
  if (!result) ADD_FAILURE() << result.error().text;
  return result ? std::move(*result) : ExplainResult{};
}

TEST(SignalExperiment, FrictionsAtOnePressureAreToldApartByPressuresThatAreAllowed) {
  const std::string machine =
      SealMachineWith("[experiment]\nsignals = { p = { min = 1, max = 7, unit = \"bar\" } }");
  const ExplainResult result = Explain(Logs(OnePressure()), machine);
  ASSERT_EQ(result.explanation.verdict, Verdict::kAmbiguous);
  const SignalExperiment& e = result.signal_experiment;
  ASSERT_EQ(e.signals.size(), 1u) << SignalExperimentText(e).english;
  EXPECT_EQ(e.signals[0].signal, "p");
  for (const auto& [low, high] : e.signals[0].levels) {
    EXPECT_EQ(low, high);
    EXPECT_GE(low, 1e5);
    EXPECT_LE(high, 7e5);
  }
  EXPECT_LT(e.separation_now, 60);
  EXPECT_TRUE(e.settles());
  EXPECT_THAT(WhatToRecord(result).value_or(Told{}).english, HasSubstr("bar"));
  EXPECT_EQ(ExplainJson(result)["experiment_plan"]["signals"][0]["signal"], "p");

  std::vector<double> pressures;
  for (const auto& [low, high] : e.signals[0].levels) pressures.push_back(low / 1e5);
  std::vector<std::string> both = Logs(OnePressure());
  for (std::string& log : Logs({.coulomb = 5.0, .seed = 22, .pressures = pressures}))
    both.push_back(std::move(log));
  const ExplainResult after = Explain(both, machine);
  EXPECT_EQ(after.explanation.verdict, Verdict::kNamed);
  EXPECT_THAT(after.explanation.set, ElementsAre("coulomb_friction"));
}

TEST(SignalExperiment, FrictionsAtOneSpeedAreToldApartBySpeedsThatAreAllowed) {
  const std::string machine = SealMachineWith(
      "[[effect]]\nid = \"viscous_friction\"\nterms = { d = \"ddt(x)\" }\nmin = 0\n\n"
      "[experiment]\nsignals = { \"abs(ddt(x))\" = { min = 5, max = 30, unit = \"mm/s\" } }",
      "10");  // strokes without their turns
  const Seal one_speed{.coulomb = 1.5, .seed = 23};
  const ExplainResult result = Explain(Logs(one_speed), machine);
  ASSERT_EQ(result.explanation.verdict, Verdict::kAmbiguous);
  EXPECT_THAT(result.explanation.set, IsSupersetOf({"coulomb_friction", "viscous_friction"}));
  const SignalExperiment& e = result.signal_experiment;
  ASSERT_EQ(e.signals.size(), 1u) << SignalExperimentText(e).english;
  EXPECT_TRUE(e.signals[0].speed);
  EXPECT_TRUE(e.settles());
  EXPECT_THAT(SignalExperimentText(e).english, HasSubstr("the speed of x at"));

  Seal asked{.coulomb = 1.5, .seed = 24, .speeds = {}};
  for (const auto& [low, high] : e.signals[0].levels) {
    EXPECT_GE(low, 0.010) << "the gate";
    EXPECT_LE(high, 0.030);
    asked.speeds.push_back(low);
  }
  std::vector<std::string> both = Logs(one_speed);
  for (std::string& log : Logs(asked)) both.push_back(std::move(log));
  const ExplainResult after = Explain(both, machine);
  EXPECT_EQ(after.explanation.verdict, Verdict::kNamed);
  EXPECT_THAT(after.explanation.set, ElementsAre("coulomb_friction"));
}

TEST(SignalExperiment, MovesThatNoLawReadsAreSaidToBeOfNoUse) {
  const std::string machine =
      SealMachineWith("[experiment]\nsignals = { F = { min = 1, max = 7, unit = \"N\" } }");
  const ExplainResult result = Explain(Logs(OnePressure()), machine);
  EXPECT_TRUE(result.signal_experiment.unusable);
  EXPECT_THAT(WhatToRecord(result).value_or(Told{}).english,
              HasSubstr("Nothing that [experiment] allows can be used"));
}

TEST(SignalExperiment, WithoutMovesAllowedItSaysWhatIsMissing) {
  const ExplainResult result = Explain(Logs(OnePressure()), kSealMachine);
  ASSERT_EQ(result.explanation.verdict, Verdict::kAmbiguous);
  EXPECT_EQ(result.signal_experiment.strokes, 0);
  EXPECT_LT(result.signal_experiment.separation, 60);
  EXPECT_THAT(WhatToRecord(result).value_or(Told{}).english, HasSubstr("read p, x"));
  EXPECT_TRUE(ExplainJson(result)["experiment_plan"].is_null());
}

TEST(SignalExperiment, ASignalTheBalanceTiesToItsOutputIsNotMoved) {
  PressOptions press;
  press.seconds = 60;
  press.seed = 31;
  press.effects = {{"internal_leakage", 0.9e-12, {}}};
  Machine machine = CushionAsExpressions(MachineFor(press));
  machine.user_effects = {{"past_the_seal", "Oil passes the seal", {{"k_i", "p_A - p_B", ""}}},
                          {"to_outside", "Oil is lost", {{"k_e", "p_A", ""}}}};
  machine.experiment.signals = {{"p_A", false, 40e5, 200e5, false}};
  auto strokes = StrokesOf(SimulatePress(press), machine, KeepSamples::kYes);
  ASSERT_TRUE(strokes) << strokes.error().text;
  const auto result = ExplainStrokes(std::move(*strokes));
  ASSERT_TRUE(result) << result.error().text;
  ASSERT_EQ(result->explanation.verdict, Verdict::kAmbiguous);
  EXPECT_EQ(result->signal_experiment.tied, "z");
  EXPECT_THAT(SignalExperimentText(result->signal_experiment).english, HasSubstr("only strokes as recorded"));
}

}  // namespace
}  // namespace hydroscope
