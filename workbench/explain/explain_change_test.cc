#include "workbench/explain/explain_change.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "studies/simulated_strokes.h"
#include "workbench/explain/explain_output.h"
#include "workbench/history/history_output.h"

namespace hydroscope {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

PressOptions Cushion(std::uint64_t seed, std::vector<EffectSetting> effects) {
  PressOptions options;
  options.seconds = 90;
  options.seed = seed;
  options.effects = std::move(effects);
  return options;
}

/// The strokes of a simulated log as a database would hand them over.
StrokeHistory HistoryOf(const PressOptions& options) {
  const Machine machine = MachineFor(options);
  const auto log = StrokesOf(SimulatePress(options), machine);
  EXPECT_TRUE(log.has_value());
  StrokeHistory history;
  history.machine = machine;
  history.model = log->model;
  history.window = log->window;
  history.units = log->Grams();
  const auto count = static_cast<std::int64_t>(history.units.size());
  history.parts = {{machine.name, 1, 0, count}};
  for (std::int64_t k = 0; k < count; ++k) history.unit_parts.push_back({machine.name, 1, k, k + 1});
  for (const StrokeRecord& stroke : log->strokes) history.sample.push_back(stroke.summary);
  return history;
}

const EffectSetting kLeak = {"internal_leakage", 5e-12, {}};
const EffectSetting kHysteresis = {"spool_hysteresis", 0.01, {}};

TEST(ExplainHistory, SumsOfProductsAloneNameTheEffect) {
  const auto result = ExplainHistory(HistoryOf(Cushion(3, {kLeak})));
  ASSERT_TRUE(result.has_value());
  EXPECT_THAT(result->explanation.set, Contains("internal_leakage"));
  const auto healthy = ExplainHistory(HistoryOf(Cushion(3, {})));
  ASSERT_TRUE(healthy.has_value());
  EXPECT_EQ(healthy->explanation.verdict, Verdict::kAdequate);
}

TEST(ExplainHistory, NoiseThatIsNotWhiteLeavesALogToBeAskedFor) {
  PressOptions options = Cushion(3, {kLeak});
  options.imperfections = {{"coloured_noise", 1, {{"phi", 0.8}, {"white", 1}}, "all"}};
  StrokeHistory history = HistoryOf(options);
  for (const bool known : {false, true}) {
    history.noise_known = known;
    const auto result = ExplainHistory(history);
    ASSERT_TRUE(result.has_value());
    ASSERT_EQ(result->explanation.verdict, Verdict::kUnknown);
    EXPECT_EQ(result->explanation.doubt.english.find("in a log of this machine") != std::string::npos,
              !known);
  }
}

/// A tank line at another pressure gives the same flow, and stored sums have no columns of it.
TEST(ExplainHistory, ANameWhoseTwinIsNotStoredIsDoubted) {
  const auto result = ExplainHistory(HistoryOf(Cushion(3, {{"pressure_offset", 6e5, {}}})));
  ASSERT_TRUE(result.has_value());
  ASSERT_THAT(result->explanation.set, Contains("pressure_offset"));
  EXPECT_TRUE(result->explanation.partial);
  EXPECT_THAT(result->explanation.doubt.english, HasSubstr("tank_pressure looks the same"));
}

TEST(ExplainHistory, AnEffectThatWasAddedWronglyIsReplaced) {
  StrokeHistory history = HistoryOf(Cushion(3, {{"relief_valve", 8e-11, {{"crack", 150e5}}}}));
  history.machine.added_effects = {"external_leakage"};
  const auto result = ExplainHistory(history);
  ASSERT_TRUE(result.has_value());
  ASSERT_TRUE(result->explanation.swap.has_value()) << ExplainText(*result);
  EXPECT_EQ(result->explanation.swap->out, "external_leakage");
  EXPECT_THAT(result->explanation.swap->in, Contains("relief_valve"));
}

TEST(ExplainHistory, AThresholdBetweenTheGridValuesIsFoundByInterpolation) {
  const auto result = ExplainHistory(HistoryOf(Cushion(5, {{"relief_valve", 5e-11, {{"crack", 160e5}}}})));
  ASSERT_TRUE(result.has_value());
  ASSERT_EQ(result->explanation.final.effects.size(), 1u);
  EXPECT_THAT(result->explanation.set, Contains("relief_valve"));
  EXPECT_NEAR(result->NonlinearOf(result->explanation.chosen.front()).front(), 160e5, 10e5);
}

TEST(ExplainHistory, ADelayFarFromTheStoredOneIsNotTakenForTwoEffects) {
  const auto result = ExplainHistory(HistoryOf(Cushion(6, {{"pressure_signal_delay", 0.016, {}}})));
  ASSERT_TRUE(result.has_value());
  for (const std::string& id : result->explanation.set) EXPECT_EQ(id, "pressure_signal_delay");
}

TEST(ExplainHistory, TooFewStrokesAreAnErrorThatSaysSo) {
  StrokeHistory history = HistoryOf(Cushion(3, {}));
  history.units.resize(3);
  const auto result = ExplainHistory(history);
  ASSERT_FALSE(result.has_value());
  EXPECT_THAT(result.error().text, HasSubstr("expected at least 4"));
}

TEST(ExplainChange, ALeakThatAppearsIsNamedAndTheParametersStay) {
  const StrokeHistory before = HistoryOf(Cushion(3, {})), after = HistoryOf(Cushion(4, {kLeak}));
  const auto result = ExplainChange(before, after);
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->before.explanation.verdict, Verdict::kAdequate);
  EXPECT_THAT(result->after.explanation.set, Contains("internal_leakage"));
  EXPECT_THAT(result->appeared, Contains("internal_leakage"));
  const nlohmann::json json = ChangeJson(before, after, *result);
  EXPECT_GT(json["change"]["after"]["effects"]["internal_leakage"]["value"].get<double>(), 4e-12);
  for (const char* name : {"K", "V0", "Q_vn", "y_0"})
    EXPECT_TRUE(json["change"]["parameters"].contains(name)) << name;
  EXPECT_FALSE(json["change"]["parameters"]["Q_vn"]["significant"]) << ChangeText(*result);
}

/// What another effect would explain as well, of which nothing is stored, is no proof: the first line says so, not the body alone.
TEST(ExplainChange, AHeadlineIsNoSurerThanItsBody) {
  const StrokeHistory before = HistoryOf(Cushion(3, {})), after = HistoryOf(Cushion(4, {kLeak}));
  const auto result = ExplainChange(before, after);
  ASSERT_TRUE(result.has_value());
  ASSERT_EQ(result->after.explanation.verdict, Verdict::kNamed);
  ASSERT_THAT(ChangeText(*result), HasSubstr("Not proven: supply_leakage looks the same"));
  EXPECT_THAT(ChangeText(*result),
              testing::StartsWith("NAMED, NOT PROVEN: this, or a relative of it, appeared or changed.\n"));
  EXPECT_EQ(ChangeJson(before, after, *result)["cause_kind"], "not_proven");
}

TEST(ExplainChange, WhatWasThereBeforeIsNoChange) {
  const auto result =
      ExplainChange(HistoryOf(Cushion(3, {kHysteresis})), HistoryOf(Cushion(4, {kHysteresis})));
  ASSERT_TRUE(result.has_value());
  EXPECT_THAT(result->before.explanation.set, Contains("spool_hysteresis"));
  EXPECT_EQ(result->after.explanation.verdict, Verdict::kAdequate) << ChangeText(*result);
  EXPECT_THAT(result->appeared, IsEmpty());
}

TEST(ExplainChange, SizesAtTwoThresholdsAreNoChange) {
  const EffectSetting valve = {"relief_valve", 4.6e-11, {{"crack", 137e5}}};
  for (const std::uint64_t seed : {11, 21, 31}) {
    const auto result =
        ExplainChange(HistoryOf(Cushion(seed, {valve})), HistoryOf(Cushion(seed + 1, {valve})));
    ASSERT_TRUE(result.has_value());
    EXPECT_THAT(result->after.explanation.set, IsEmpty()) << ChangeText(*result);
  }
}

TEST(ExplainChange, AnEffectBesideANewOneIsNotSaidToHaveChanged) {
  const EffectSetting tank = {"tank_back_pressure", 1.2e12, {}};
  const auto result = ExplainChange(HistoryOf(Cushion(7, {tank})),
                                    HistoryOf(Cushion(8, {tank, {"spool_signal_delay", 0.005, {}}})));
  ASSERT_TRUE(result.has_value());
  EXPECT_THAT(result->after.explanation.set, ElementsAre("spool_signal_delay")) << ChangeText(*result);
}

TEST(ExplainChange, WearThatGoesOnIsNamedOnTheNewestStrokes) {
  StrokeHistory after = HistoryOf(Cushion(4, {{"internal_leakage", 2e-12, {}}}));
  std::uint64_t seed = 10;
  for (const double size : {4e-12, 6e-12, 8e-12}) {
    const StrokeHistory more = HistoryOf(Cushion(seed++, {{"internal_leakage", size, {}}}));
    for (const StrokeGram& unit : more.units) {
      after.units.push_back(unit);
      const std::int64_t at = after.parts.front().last++;
      after.unit_parts.push_back({after.parts.front().machine, 1, at, at + 1});
    }
  }
  const auto result = ExplainChange(HistoryOf(Cushion(3, {})), after);
  ASSERT_TRUE(result.has_value());
  EXPECT_THAT(result->after.explanation.set, Contains("internal_leakage")) << ChangeText(*result);
  EXPECT_GT(result->newest, 0);
  EXPECT_LT(result->newest, after.strokes());
}

/// The change is said to have begun somewhat before it did.
TEST(ExplainChange, HealthyStrokesAmongThoseAfterHideNoLeak) {
  for (const std::uint64_t seed : {4u, 5u, 6u}) {
    const StrokeHistory healthy = HistoryOf(Cushion(seed, {}));
    StrokeHistory after = HistoryOf(Cushion(seed, {{"internal_leakage", 3e-12, {}}}));
    std::copy_n(healthy.units.begin(), after.units.size() / 4, after.units.begin());
    const auto result = ExplainChange(HistoryOf(Cushion(3, {})), after);
    ASSERT_TRUE(result.has_value());
    EXPECT_THAT(result->appeared, Contains("internal_leakage")) << ChangeText(*result);
  }
}

TEST(ExplainChange, AnEffectThatGrowsIsNamed) {
  const auto result = ExplainChange(HistoryOf(Cushion(3, {{"internal_leakage", 3e-12, {}}})),
                                    HistoryOf(Cushion(4, {{"internal_leakage", 9e-12, {}}})));
  ASSERT_TRUE(result.has_value());
  ASSERT_THAT(result->before.explanation.set, Contains("internal_leakage"));
  EXPECT_EQ(result->after.explanation.verdict, Verdict::kNamed) << ChangeText(*result);
  EXPECT_THAT(result->after.explanation.set, ElementsAre("internal_leakage"));
  EXPECT_THAT(result->appeared, IsEmpty());
  ASSERT_EQ(result->effects.size(), 1u);
  EXPECT_NEAR(result->effects[0].change(), 6e-12, 3 * result->effects[0].std());
}

}  // namespace
}  // namespace hydroscope
