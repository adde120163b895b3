#include "workbench/explain/explain_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "studies/simulated_strokes.h"
#include "workbench/explain/what_to_record.h"

namespace hydroscope {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

PressOptions Cushion(std::vector<EffectSetting> effects) {
  PressOptions options;
  options.seconds = 60;
  options.seed = 7;
  options.effects = std::move(effects);
  return options;
}

ExplainResult Explained(const PressOptions& options, const ExplainOptions& explain = {},
                        std::vector<std::string> added = {}) {
  Machine machine = MachineFor(options);
  machine.added_effects = std::move(added);
  auto strokes = StrokesOf(SimulatePress(options), machine, KeepSamples::kYes);
  EXPECT_TRUE(strokes.has_value());
  auto result = ExplainStrokes(std::move(*strokes), explain);
  EXPECT_TRUE(result.has_value());
  result->target = "--machine press.toml";
  return std::move(*result);
}

TEST(ExplainOutput, ANamedEffectComesWithWhatToLookForAndTheCommandThatAddsIt) {
  const ExplainResult result = Explained(Cushion({{"internal_leakage", 5e-12, {}}}));
  ASSERT_EQ(result.explanation.verdict, Verdict::kNamed);
  EXPECT_THAT(
      ExplainText(result),
      AllOf(StartsWith("NAMED"), HasSubstr("piston seal"), HasSubstr("look for"), HasSubstr("l/min per bar"),
            HasSubstr("hydroscope model add internal_leakage --machine press.toml")));
  const nlohmann::json json = ExplainJson(result);
  const nlohmann::json& size = json["final"]["effects"]["internal_leakage"]["G"];
  EXPECT_NEAR(size["value"].get<double>(), 5e-12, 3 * size["std"].get<double>());
  EXPECT_THAT(json["set"], Contains("internal_leakage"));
}

TEST(ExplainOutput, ANameThatIsNotProvenSaysSoFirst) {
  ExplainResult result = Explained(Cushion({{"internal_leakage", 5e-12, {}}}));
  result.explanation.partial = true;
  EXPECT_THAT(ExplainText(result),
              StartsWith("NAMED, NOT PROVEN: the model misses one effect, this or a relative of it."));
  EXPECT_EQ(ExplainJson(result)["cause_kind"], "not_proven");
  result.explanation.verdict = Verdict::kAmbiguous;
  result.explanation.groups = {{"internal_leakage", "entrained_air"}};
  EXPECT_THAT(ExplainText(result), StartsWith("AMBIGUOUS, NOT PROVEN: "));
}

TEST(ExplainOutput, WhatTheModelHasAlreadyIsNotLookedForAgain) {
  const PressOptions options = Cushion({{"internal_leakage", 5e-12, {}}});
  const ExplainResult result = Explained(options, {}, {"internal_leakage"});
  EXPECT_EQ(result.explanation.verdict, Verdict::kAdequate);
  const nlohmann::json json = ExplainJson(result);
  const nlohmann::json& size = json["base"]["effects"]["internal_leakage"]["G"];
  EXPECT_NEAR(size["value"].get<double>(), 5e-12, 3 * size["std"].get<double>());
  for (const auto& ranked : json["ranking"]) EXPECT_NE(ranked["effect"], "internal_leakage");
}

TEST(ExplainOutput, TheSecondEffectIsFoundOnTopOfTheOneTheModelHas) {
  const PressOptions options =
      Cushion({{"relief_valve", 4e-11, {{"crack", 170e5}}}, {"spool_hysteresis", 0.01, {}}});
  const ExplainResult result = Explained(options, {}, {"relief_valve"});
  ASSERT_EQ(result.explanation.verdict, Verdict::kNamed);
  EXPECT_THAT(result.explanation.set, testing::ElementsAre("spool_hysteresis"));
  const nlohmann::json json = ExplainJson(result);
  EXPECT_EQ(json["steps"].size(), 2u);
  EXPECT_NEAR(json["final"]["effects"]["relief_valve"]["p_crack"]["value"].get<double>(), 170e5, 8e5);
  EXPECT_EQ(json["base"]["rms_holdout"], json["steps"][0]["rms_holdout"]);
}

TEST(ExplainOutput, OfTwoEffectsOneActsOnTheSignalsThatTheOtherCorrects) {
  const PressOptions options =
      Cushion({{"position_signal_delay", 0.0145, {}}, {"spool_signal_delay", 0.0092, {}}});
  const ExplainResult found = Explained(options);
  // Each may be a delay or a lag.
  EXPECT_THAT(found.explanation.set, testing::IsSupersetOf({"position_signal_delay", "spool_signal_delay"}));
  // The model that has both says the same of them.
  const ExplainResult extended = Explained(options, {}, {"position_signal_delay", "spool_signal_delay"});
  EXPECT_EQ(extended.explanation.verdict, Verdict::kAdequate);
  for (const nlohmann::json& effects : {ExplainJson(extended)["base"]["effects"]}) {
    EXPECT_NEAR(effects["position_signal_delay"]["t_d"]["value"].get<double>(), 0.0145, 0.0008);
    EXPECT_NEAR(effects["spool_signal_delay"]["t_d"]["value"].get<double>(), 0.0092, 0.0006);
  }
}

TEST(ExplainOutput, AnEffectOutsideTheLibraryIsUnknownAndNamesNone) {
  ExplainOptions options;
  options.exclude = {"spool_hysteresis"};
  const ExplainResult result = Explained(Cushion({{"spool_hysteresis", 0.02, {}}}), options);
  ASSERT_EQ(result.explanation.verdict, Verdict::kUnknown);
  EXPECT_THAT(ExplainText(result),
              AllOf(StartsWith("UNKNOWN"), Not(HasSubstr("model add")), HasSubstr("hydroscope compare")));
  EXPECT_TRUE(ExplainJson(result)["set"].empty());
}

TEST(ExplainOutput, OneRamSpeedForAllStrokesAsksForOthers) {
  PressOptions options = Cushion({});
  options.motion.speed_min = options.motion.speed_max = 0.05;
  const ExplainResult result = Explained(options);
  EXPECT_THAT(WhatToRecord(result).value_or(Told{}).english,
              AllOf(HasSubstr("same ram speed"), HasSubstr("mm/s")));
  EXPECT_TRUE(ExplainJson(result)["experiment"].is_string());
}

TEST(ExplainOutput, WhatStandsOutLowersTheErrorOnStrokesLeftOut) {
  for (const std::uint64_t seed : {7, 8, 9}) {
    PressOptions options = Cushion({{"spool_overlap", 0.004, {}}});
    options.seed = seed;
    const ExplainResult result = Explained(options);
    const Explanation& x = result.explanation;
    for (const RankedEffect& ranked : x.ranking)
      EXPECT_TRUE(!ranked.significant || ranked.fit.rms_holdout < x.base.rms_holdout) << ranked.id;
    EXPECT_TRUE(x.set.empty() || x.final.rms_holdout < x.base.rms_holdout);
  }
}

TEST(ExplainOutput, AnEffectThatWasAddedWronglyIsReplaced) {
  const PressOptions options = Cushion({{"relief_valve", 8e-11, {{"crack", 150e5}}}});
  const ExplainResult result = Explained(options, {}, {"external_leakage"});
  ASSERT_TRUE(result.explanation.swap.has_value());
  EXPECT_EQ(result.explanation.swap->out, "external_leakage");
  EXPECT_THAT(result.explanation.swap->in, Contains("relief_valve"));
  EXPECT_THAT(ExplainText(result), HasSubstr("Replace external_leakage by relief_valve: error"));
  EXPECT_THAT(ExplainText(result), testing::Not(HasSubstr("Make it part of the model")));
  EXPECT_EQ(ExplainJson(result)["swap"]["out"], "external_leakage");
}

/// Beside the wrong effect a second one would be named, or strokes would be parted into odd and good ones.
TEST(ExplainOutput, AWrongEffectIsReplacedBeforeASecondIsNamedOrStrokesAreParted) {
  for (const std::uint64_t seed : {7, 8}) {
    PressOptions options = Cushion({{"internal_leakage", 4.5e-12, {}}});
    options.seed = seed;
    const ExplainResult result = Explained(options, {}, {"external_leakage"});
    const Explanation& x = result.explanation;
    ASSERT_TRUE(x.swap.has_value()) << seed << ExplainText(result);
    EXPECT_EQ(x.swap->out, "external_leakage");
    EXPECT_THAT(x.swap->in, testing::ElementsAre("internal_leakage"));
    EXPECT_TRUE(x.swap->explains);
    EXPECT_TRUE(x.odd_strokes.empty());
    EXPECT_THAT(
        ExplainText(result),
        AllOf(StartsWith(
                  "SWAP: the model has external_leakage, and internal_leakage in its place does better."),
              HasSubstr("Replace external_leakage by internal_leakage"), Not(HasSubstr("AMBIGUOUS"))));
    EXPECT_TRUE(ExplainJson(result)["swap"]["proven"].get<bool>());
  }
}

TEST(ExplainOutput, WhatIsLeftIsShownAsACurveOverItsSignal) {
  ExplainOptions options;
  options.exclude = {"relief_valve"};
  const ExplainResult result = Explained(Cushion({{"relief_valve", 8e-11, {{"crack", 150e5}}}}), options);
  ASSERT_EQ(result.explanation.verdict, Verdict::kUnknown);
  ASSERT_TRUE(result.remainder.has_value());
  EXPECT_THAT(ExplainText(result), HasSubstr("Shape of what is missing"));
  const nlohmann::json json = ExplainJson(result)["remainder"];
  EXPECT_EQ(json["points"].size(), result.remainder->points.size());
  EXPECT_TRUE(json["points"][0].contains("std"));
}

TEST(ExplainOutput, AnEffectWhoseSensorIsBrokenCannotBeTested) {
  PressOptions options = Cushion({{"internal_leakage", 5e-12, {}}});
  options.faults = {{FaultKind::kNan, "p_B", 0, 60, 0}};
  const ExplainResult result = Explained(options);
  EXPECT_THAT(result.explanation.set, Not(Contains("internal_leakage")));
  bool seen = false;
  for (const RankedEffect& ranked : result.explanation.ranking) {
    if (ranked.id != "internal_leakage") continue;
    seen = true;
    EXPECT_FALSE(ranked.testable);
    EXPECT_THAT(ranked.why_not.english, HasSubstr("no usable samples"));
  }
  EXPECT_TRUE(seen);
}

TEST(ExplainOutput, ABadSensorInSomeStrokesLeavesTheOthers) {
  PressOptions options = Cushion({{"internal_leakage", 5e-12, {}}});
  options.faults = {{FaultKind::kNan, "p_B", 0, 20, 0}};
  const ExplainResult result = Explained(options);
  // Its rivals are judged on all strokes, so it need not come out alone.
  EXPECT_THAT(result.explanation.set, Contains("internal_leakage"));
  for (const RankedEffect& ranked : result.explanation.ranking) {
    if (ranked.id == "internal_leakage") {
      EXPECT_TRUE(ranked.testable && ranked.significant);
    }
  }
}

TEST(ExplainOutput, TheErrorOfAReliefValveIsLocatedAtHighPressure) {
  const ExplainResult result = Explained(Cushion({{"relief_valve", 4e-11, {{"crack", 170e5}}}}));
  ASSERT_FALSE(result.location.located.empty());
  bool at_high_pressure = false;
  for (const Located& l : result.location.located)
    at_high_pressure = at_high_pressure || (l.signal == "p_A" && l.from > 140);
  EXPECT_TRUE(at_high_pressure);
}

TEST(ExplainOutput, AHealthyCushionHasNothingLocated) {
  EXPECT_TRUE(Explained(Cushion({})).location.located.empty());
}

}  // namespace
}  // namespace hydroscope
