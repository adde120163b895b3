#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>

#include "service/benchmarks/seal_friction.h"
#include "service/benchmarks/simulated_strokes.h"
#include "service/explain_log.h"
#include "simulator/press.h"

namespace hydroscope {
namespace {

using ::testing::Contains;
using ::testing::UnorderedElementsAre;

/// What is true of a simulated cylinder: force = A p + c + (F_c + mu p) sign(v).
struct Seal {
  double bore = 0.0257, c = 1.0, coulomb = 0, friction = 0;
  double noise = 0.3;  ///< N
  std::uint64_t seed = 1;
};

/// Three runs at constant pressures on a triangle in x with short rests where it turns, 100 rows a second,
/// written as logs in the layout of machines/seal_friction.toml.
std::vector<std::string> Logs(const Seal& seal) {
  std::mt19937_64 random(seal.seed);
  std::normal_distribution<double> normal;
  const double area = std::numbers::pi / 4 * seal.bore * seal.bore;
  std::vector<std::string> logs;
  for (const double bar : {1.0, 3.5, 6.0}) {
    logs.push_back(testing::TempDir() + "seal_" + std::to_string(seal.seed) + "_" +
                   std::to_string(logs.size()) + ".csv");
    std::ofstream out(logs.back());
    out << std::fixed;
    double x = 0;  // m
    for (int row = 0; row < 3000; ++row) {
      const double phase = std::fmod(row * 0.01, 4.0);  // s: 1.6 out, 0.4 rest, 1.6 back, 0.4 rest
      const double v = phase < 1.6 ? 0.013 : phase < 2.0 ? 0 : phase < 3.6 ? -0.013 : 0;
      x += 0.01 * v;
      const double sign = phase >= 1.8 && phase < 3.8 ? -1 : 1;  // the seal holds on while the piston rests
      const double p = 1e5 * (bar + 0.05 * sign) + 200 * std::sin(0.7 * row);
      const double force =
          area * p + seal.c + (seal.coulomb + seal.friction * p) * sign + seal.noise * normal(random);
      out << row * 10.0 << "\t0\t0\t0\t" << 1e3 * x + 0.004 * normal(random) << '\t'
          << p / 1e5 + 0.0005 * normal(random) << '\t' << force << '\n';
    }
  }
  return logs;
}

ExplainResult ExplainSeal(const Seal& seal) {
  auto result = ExplainLogs(Logs(seal), std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/seal_friction.toml");
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

/// The die cushion's balance as a user would write it.
Machine CushionAsExpressions(const Machine& built_in) {
  Machine machine = built_in;
  machine.model = "expressions";
  machine.geometry["A_A"].unit = "m2";
  machine.balance.output = "A_A*ddt(z)";
  machine.balance.unit = "m3/s";
  machine.balance.terms = {{"q", "sqrt(max(p_A, 0))*y_v", ""},
                           {"t2", "ddt(p_A)", ""},
                           {"t3", "z*ddt(p_A)", ""},
                           {"n", "sqrt(max(p_A, 0))", ""}};
  machine.balance.derived = {{"K", "-A_A/t3", "Pa"}, {"V0", "A_A*t2/t3", "m3"}};
  return machine;
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
