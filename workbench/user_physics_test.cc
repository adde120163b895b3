#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "simulator/die_cushion/press.h"
#include "studies/seal_friction.h"
#include "studies/simulated_strokes.h"
#include "workbench/explain/explain_log.h"
#include "workbench/explain/own_machine_fixture.h"

namespace hydroscope {
namespace {

using ::testing::Contains;
using ::testing::UnorderedElementsAre;

ExplainResult ExplainSeal(const Seal& seal) {
  auto result = ExplainLogs(Logs(seal), kSealMachine);
  if (!result) ADD_FAILURE() << result.error().text;
  return result ? std::move(*result) : ExplainResult{};
}

Estimate ParameterOf(const ExplainResult& result, const std::string& name) {
  for (const Estimate& e :
       BaseParameters(*result.log.model, result.explanation.final, static_cast<int>(result.strokes)))
    if (e.parameter == name) return e;
  ADD_FAILURE() << name;
  return {};
}

TEST(UserPhysics, FrictionHiddenInAForceBalanceIsNamedAndMeasured) {
  const ExplainResult result = ExplainSeal({.coulomb = 4.0, .friction = 1.5e-5});
  const Explanation& x = result.explanation;
  EXPECT_EQ(x.verdict, Verdict::kNamed) << VerdictName(x.verdict);
  EXPECT_THAT(x.set, UnorderedElementsAre("coulomb_friction", "pressure_friction"));
  EXPECT_GT(x.base.rms_holdout, 5.0);
  EXPECT_LT(x.final.rms_holdout, 1.1 * x.final.noise_floor);
  for (const EffectEstimate& e : x.final.effects) {
    const double truth = result.effect(e.choice.effect).id == "coulomb_friction" ? 4.0 : 1.5e-5;
    EXPECT_NEAR(e.size, truth, 3 * e.std) << result.effect(e.choice.effect).id;
    EXPECT_LT(e.std, 0.05 * truth);
  }
  EXPECT_NEAR(ParameterOf(result, "bore").value, 0.0257, 3 * ParameterOf(result, "bore").std);
  EXPECT_LT(ParameterOf(result, "bore").std, 5e-5);
}

TEST(UserPhysics, OneKindOfFrictionIsNotTakenForTheOther) {
  EXPECT_THAT(ExplainSeal({.coulomb = 5.0, .seed = 2}).explanation.set,
              testing::ElementsAre("coulomb_friction"));
  EXPECT_THAT(ExplainSeal({.friction = 2e-5, .seed = 3}).explanation.set,
              testing::ElementsAre("pressure_friction"));
}

TEST(UserPhysics, ABalanceThatIsCompleteIsAdequate) {
  for (std::uint64_t seed = 4; seed < 10; ++seed)
    EXPECT_EQ(ExplainSeal({.seed = seed}).explanation.verdict, Verdict::kAdequate) << seed;
}

TEST(UserPhysics, TheMeasuredSealLeadsToItsFriction) {
  const char* set = std::getenv("HYDROSCOPE_DATA");
  const std::string folder =
      set != nullptr ? std::string(set) : std::string(HYDROSCOPE_SOURCE_DIR) + "/../shared/data";
  if (!std::filesystem::exists(folder + "/seal_friction")) GTEST_SKIP() << "no measured runs in " << folder;
  EXPECT_EQ(RunSealFriction({folder + "/seal_friction",
                             std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/seal_friction.toml"}),
            0);
}

PressOptions Press(std::uint64_t seed) {
  PressOptions options;
  options.seed = seed;
  options.seconds = 60;
  return options;
}

TEST(UserPhysics, TheDieCushionWrittenAsExpressionsGivesTheSameParameters) {
  const Machine built_in = MachineFor(Press(1));
  const SimulatedLog log = SimulatePress(Press(1));
  const auto a = StrokesOf(log, built_in);
  const auto b = StrokesOf(log, CushionAsExpressions(built_in));
  ASSERT_TRUE(a) << a.error().text;
  ASSERT_TRUE(b) << b.error().text;
  const auto fit_a = FitBaseModel(*a->model, a->Grams(), a->window);
  const auto fit_b = FitBaseModel(*b->model, b->Grams(), b->window);
  ASSERT_TRUE(fit_a && fit_b);
  int compared = 0;
  for (const Estimate& own : fit_b->parameters)
    for (const Estimate& theirs : fit_a->parameters) {
      if (own.parameter != theirs.parameter) continue;
      EXPECT_NEAR(own.value, theirs.value, 0.1 * theirs.std) << own.parameter;
      ++compared;
    }
  EXPECT_EQ(compared, 2);
  EXPECT_NEAR(fit_b->rms_holdout, fit_a->rms_holdout, 0.01 * fit_a->rms_holdout);
  EXPECT_NEAR(fit_b->noise_floor, fit_a->noise_floor, 0.02 * fit_a->noise_floor);
}

TEST(UserPhysics, AnEffectOfTheUserRanksBesideTheLibraryAndCanBeAdded) {
  PressOptions press = Press(5);
  press.seconds = 90;
  press.effects.emplace_back();
  press.effects.back().id = "position_dependent_leakage";
  press.effects.back().size = 1.5e-11;
  Machine machine = MachineFor(press);
  machine.user_effects = {
      {"worn_bore", "Worn zone of the bore", {{"leak_z", "(p_A - p_B) * exp(-((z - 0.11)/0.02)^2)", ""}}}};
  const SimulatedLog log = SimulatePress(press);
  const auto strokes = [&] { return *StrokesOf(log, machine, KeepSamples::kYes); };
  ExplainOptions options;
  options.exclude = {"position_dependent_leakage"};  // the built-in one of the same law
  const auto found = ExplainStrokes(strokes(), options);
  ASSERT_TRUE(found) << found.error().text;
  EXPECT_THAT(found->explanation.set, Contains("worn_bore"));
  machine.added_effects = {"worn_bore"};
  const auto again = ExplainStrokes(strokes(), options);
  ASSERT_TRUE(again) << again.error().text;
  EXPECT_NEAR(again->explanation.base.effects.at(0).size, 1.5e-11,
              3 * again->explanation.base.effects[0].std + 1e-12);
  EXPECT_LT(again->explanation.base.rms_holdout, found->explanation.base.rms_holdout);
}

TEST(UserPhysics, RowsOnWhichAnExpressionFailsAreCountedAndLeftOut) {
  Machine machine = CushionAsExpressions(MachineFor(Press(1)));
  const auto all = StrokesOf(SimulatePress(Press(1)), machine);
  ASSERT_TRUE(all) << all.error().text;
  machine.balance.terms[3].expression = "sqrt(p_A - 80e5)";
  const auto strokes = StrokesOf(SimulatePress(Press(1)), machine);
  ASSERT_TRUE(strokes) << strokes.error().text;
  EXPECT_GT(strokes->totals.flagged[12], 100) << "rows below 80 bar";
  EXPECT_EQ(all->totals.flagged[12], 0);
  EXPECT_LT(strokes->totals.used, all->totals.used - 100);
  for (const StrokeRecord& stroke : strokes->strokes)
    for (const double x : stroke.gram.integral.packed()) EXPECT_TRUE(std::isfinite(x));
}

}  // namespace
}  // namespace hydroscope
