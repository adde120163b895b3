#include "studies/own_machines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iomanip>

#include "diagnosis/subset_search.h"
#include "workbench/explain/explain_history.h"
#include "workbench/explain/explain_log.h"
#include "workbench/explain/explain_output.h"
#include "workbench/explain/own_machine_fixture.h"
#include "workbench/fit_suspicion.h"

namespace hydroscope {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

ExplainResult Explained(const OwnMachineCase& simulated, std::vector<std::string> added = {}) {
  Machine machine = OwnMachine();
  machine.added_effects = std::move(added);
  auto result = ExplainStrokes(OwnMachineStrokes(simulated, machine));
  if (!result) ADD_FAILURE() << result.error().text;
  return result ? std::move(*result) : ExplainResult{};
}

TEST(OwnMachines, HiddenEffectsAreFoundAmongEightThatAreAlike) {
  const OwnMachinesScore score = ScoreOwnMachines({.cases = 12, .seed = 3});
  EXPECT_EQ(score.wrong, 0);
  EXPECT_GE(score.in_set, 10);
  EXPECT_EQ(score.absent, 6);
  EXPECT_EQ(score.absent_named, 0);
}

TEST(OwnMachines, ThePairThatErrsLeastIsNamedAlsoWhereNoneOfItIsBestAlone) {
  const ExplainResult result =
      Explained({.hidden = {"viscous", "pressure_squared"}, .size = 2.5, .noise = 0.5, .seed = 11});
  EXPECT_EQ(result.explanation.verdict, Verdict::kNamed);
  EXPECT_THAT(result.explanation.set, UnorderedElementsAre("viscous", "pressure_squared"));
}

TEST(OwnMachines, ThreeEffectsAreFoundTogether) {
  const ExplainResult result =
      Explained({.hidden = {"coulomb", "pressure_viscous", "spring"}, .size = 4, .noise = 0.2, .seed = 5});
  EXPECT_THAT(result.explanation.set, UnorderedElementsAre("coulomb", "pressure_viscous", "spring"));
}

TEST(OwnMachines, NoSubsetThatWasPassedOverErrsLess) {
  const OwnMachineCase simulated{.hidden = {"coulomb", "drag"}, .size = 3, .seed = 8};
  const ExplainResult result = Explained(simulated);
  const LogStrokes log = OwnMachineStrokes(simulated, OwnMachine());
  const StrokeSet strokes(log.model, log.Grams(), log.window);
  for (int a = 0; a < 8; ++a)
    for (int b = a + 1; b < 8; ++b) {
      const std::vector<EffectChoice> pair = {{a, 0}, {b, 0}};
      const ExtendedFit fit = strokes.Fit(pair);
      EXPECT_TRUE(!fit.solved || fit.rms_holdout >= 0.995 * result.explanation.final.rms_holdout) << a << b;
    }
}

TEST(OwnMachines, WhatIsNamedLowersTheErrorStepByStep) {
  for (std::uint64_t seed = 20; seed < 26; ++seed) {
    const Explanation x =
        Explained({.hidden = {"stribeck"}, .size = 0.3, .noise = 0.5, .unmodelled = 0.3, .seed = seed})
            .explanation;
    if (x.set.empty()) continue;
    EXPECT_LT(x.final.rms_holdout, x.base.rms_holdout) << seed;
  }
}

TEST(OwnMachines, WhatALawThatTheFileLacksGoesWithIsSaid) {
  Machine machine = OwnMachine();
  std::erase_if(machine.user_effects, [](const auto& effect) { return effect.id == "pressure_viscous"; });
  const auto result = ExplainStrokes(OwnMachineStrokes({.hidden = {"pressure_viscous"}, .seed = 6}, machine));
  ASSERT_TRUE(result);
  EXPECT_EQ(result->explanation.verdict, Verdict::kUnknown);
  EXPECT_THAT(result->explanation.doubt.english, HasSubstr("p*ddt(x)"));
  ASSERT_FALSE(result->explanation.proposed.empty());
  EXPECT_EQ(result->explanation.proposed.front().expression, "p*ddt(x)");
  EXPECT_LT(result->explanation.proposed.front().rms_holdout, 1.1 * result->explanation.final.noise_floor);
  EXPECT_THAT(ExplainText(*result), HasSubstr("terms = { k = \"p*ddt(x)\" }"));
}

TEST(OwnMachines, ASmallLawThatTheFileLacksIsToldBesideTheNamedOne) {
  OwnMachineCase simulated{
      .hidden = {"coulomb", "coulomb", "coulomb", "pressure_viscous"}, .size = 0.05, .noise = 0.3, .seed = 4};
  Machine machine = OwnMachine();
  std::erase_if(machine.user_effects, [](const auto& effect) { return effect.id == "pressure_viscous"; });
  const auto said = [&] {
    const auto result = ExplainStrokes(OwnMachineStrokes(simulated, machine));
    EXPECT_THAT(result->explanation.set, testing::ElementsAre("coulomb"));
    return testing::Value(
        result->explanation.warnings,
        testing::Contains(testing::Field(&Told::english, HasSubstr("something else is missing"))));
  };
  EXPECT_TRUE(said());
  simulated.hidden.pop_back();
  EXPECT_FALSE(said());
}

/// The model as it is may pass for the noise, and a name would explain what little is left.
TEST(OwnMachines, NoNameIsProvenOfASmallErrorThatALawOfNoFileExplainsBetter) {
  for (const auto& [law, size] : {std::pair("spring", 0.08), std::pair("pressure_viscous", 0.04)}) {
    Machine machine = OwnMachine();
    std::erase_if(machine.user_effects,
                  [hidden = std::string(law)](const auto& effect) { return effect.id == hidden; });
    const auto result =
        ExplainStrokes(OwnMachineStrokes({.hidden = {law}, .size = size, .noise = 0.3, .seed = 4}, machine));
    ASSERT_TRUE(result);
    const Explanation& x = result->explanation;
    EXPECT_LT(x.base.excess_ratio, ExplainOptions().floor_excess) << law;
    EXPECT_TRUE(x.verdict == Verdict::kUnknown || x.partial) << law;
    EXPECT_THAT(x.doubt.english, HasSubstr("explains the error better")) << law;
  }
}

/// Stored sums have no columns of laws of general shape.
TEST(OwnMachines, StoredStrokesThatNoEffectExplainsSayThatALogTellsMore) {
  Machine machine = OwnMachine();
  machine.user_effects = {machine.user_effects.back()};
  const LogStrokes log = OwnMachineStrokes({.hidden = {"pressure_viscous"}, .seed = 6}, machine);
  StrokeHistory history;
  history.machine = machine;
  history.model = log.model;
  history.window = log.window;
  history.units = log.Grams();
  history.parts = {{machine.name, 1, 0, static_cast<std::int64_t>(history.units.size())}};
  const auto result = ExplainHistory(history);
  ASSERT_TRUE(result);
  ASSERT_EQ(result->explanation.verdict, Verdict::kUnknown);
  EXPECT_THAT(ExplainText(*result), HasSubstr("proposes what may be missing"));
}

/// A file without a single effect: what moves is what its gate looks at.
TEST(OwnMachines, TheLawOfADrySealIsProposedToAFileWithoutEffects) {
  Machine machine = LoadMachine(kSealMachine).value();
  machine.user_effects.clear();
  const Seal seal = {.friction = 3e-5, .pressures = {1, 2, 3.5, 5, 6}, .speeds = {0.008, 0.013, 0.02}};
  auto strokes = ReadStrokes(Logs(seal), machine, KeepSamples::kYes);
  ASSERT_TRUE(strokes) << strokes.error().text;
  const auto result = ExplainStrokes(std::move(*strokes));
  ASSERT_TRUE(result) << result.error().text;
  EXPECT_EQ(result->explanation.verdict, Verdict::kUnknown);
  ASSERT_FALSE(result->explanation.proposed.empty());
  EXPECT_EQ(result->explanation.proposed.front().expression, "p*sign(ddt(x))");
}

constexpr const char* kMassOnALoadCell = R"toml([machine]
name = "mass"
[log]
time = { column = "t", unit = "s" }
[signals]
x = { column = "x", unit = "m" }
F = { column = "F", unit = "N" }
[gate]
max_stroke = 5
[window]
block = 0.05
span = 1
half_width = 0.02
[balance]
output = "F"
terms = { m = { expression = "ddt(ddt(x))", unit = "kg" }, b = "ddt(x)" }
[[effect]]
id = "drag"
terms = { k = "ddt(x)*abs(ddt(x))" }
)toml";

/// A mass of 300 kg moved on sines by a force that is measured; its place is read to 20 um.
std::string LogOfAMass() {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const std::string path = testing::TempDir() + "mass_" + std::to_string(getpid()) + ".csv";
  std::ofstream out(path);
  out << std::setprecision(9) << "t,x,F\n";
  for (int row = 0; row < 20000; ++row) {
    const double t = 0.002 * row;
    double x = 0, v = 0, a = 0;
    for (const double w : {1.3, 2.9, 4.1}) {
      x += 0.02 * std::sin(w * t);
      v += 0.02 * w * std::cos(w * t);
      a -= 0.02 * w * w * std::sin(w * t);
    }
    out << t << ',' << x + 2e-5 * normal(random) << ',' << 300 * a + 800 * v + 0.5 * normal(random) << '\n';
  }
  return path;
}

/// What passes the window of a rate is smooth from row to row: rows show a fraction of its noise.
TEST(OwnMachines, TheNoiseOfAnAccelerationIsNoMissingEffect) {
  const Machine machine = ParseMachine(kMassOnALoadCell, "mass.toml").value();
  auto strokes = ReadStrokes({LogOfAMass()}, machine, KeepSamples::kYes);
  ASSERT_TRUE(strokes) << strokes.error().text;
  const auto result = ExplainStrokes(std::move(*strokes));
  ASSERT_TRUE(result) << result.error().text;
  EXPECT_EQ(result->explanation.verdict, Verdict::kAdequate);
  EXPECT_THAT(ExplainText(*result), HasSubstr("noise of x enters the balance through the window of a rate"));
}

TEST(OwnMachines, ASignalThatComesLateIsTold) {
  LogStrokes log = OwnMachineStrokes({.hidden = {}, .noise = 0.05, .seed = 4}, OwnMachine());
  const auto force = std::ranges::find(log.model->channel_names, "F") - log.model->channel_names.begin();
  for (StrokeStretches& stroke : log.stretches)
    for (Stretch& s : stroke) {
      auto& f = s.channel[static_cast<std::size_t>(force)];
      std::rotate(f.rbegin(), f.rbegin() + 1, f.rend());  // a row later
      f.front() = f[1];
    }
  const auto result = ExplainStrokes(std::move(log));
  ASSERT_TRUE(result);
  EXPECT_EQ(result->explanation.verdict, Verdict::kUnknown);
  ASSERT_FALSE(result->explanation.proposed.empty());
  EXPECT_NE(result->explanation.proposed.front().late_signal, "");
  EXPECT_THAT(ExplainText(*result), HasSubstr("not of the same moment"));
}

TEST(OwnMachines, ThreeEffectsOfOneSignalAreNoProofOfThree) {
  Machine machine = OwnMachine();
  std::erase_if(machine.user_effects, [](const auto& effect) { return effect.id == "stribeck"; });
  const auto result = ExplainStrokes(OwnMachineStrokes(
      {.hidden = {"coulomb", "viscous", "drag"}, .size = 4, .noise = 0.1, .seed = 7}, machine));
  ASSERT_TRUE(result);
  ASSERT_THAT(result->explanation.set, UnorderedElementsAre("coulomb", "viscous", "drag"));
  EXPECT_TRUE(result->explanation.partial);
  EXPECT_THAT(result->explanation.doubt.english, HasSubstr("all go with ddt(x) alone"));

  machine.added_effects = {"coulomb"};  // nor are they once one of them is added
  const auto added = ExplainStrokes(OwnMachineStrokes(
      {.hidden = {"coulomb", "viscous", "drag"}, .size = 4, .noise = 0.1, .seed = 7}, machine));
  ASSERT_TRUE(added);
  ASSERT_THAT(added->explanation.set, UnorderedElementsAre("viscous", "drag"));
  EXPECT_TRUE(added->explanation.partial);
}

/// Noise that goes on from row to row hardly shows between neighbouring rows, and is most of what blocks of them have.
TEST(OwnMachines, AnErrorThatNothingPredictsMayBeNoiseAndIsNotCalledMissing) {
  int unknown = 0;
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    const ExplainResult result = Explained({.hidden = {}, .noise = 0.3, .lasting = 0.3, .seed = seed});
    EXPECT_TRUE(result.explanation.set.empty()) << seed;
    if (result.explanation.verdict != Verdict::kUnknown) continue;
    ++unknown;
    EXPECT_TRUE(result.explanation.may_be_noise) << seed;
    EXPECT_THAT(ExplainText(result), Not(HasSubstr("misses something")));
    EXPECT_THAT(ExplainText(result), HasSubstr("half the speed"));
    EXPECT_THAT(SuspicionText(SuspicionOf(result)), HasSubstr("the noise is not white, or the model misses"));
  }
  EXPECT_GT(unknown, 0);
}

/// Of signals that the model does not read nothing can be predicted.
TEST(OwnMachines, AnErrorThatIsMuchMoreThanRowsShowIsNoNoise) {
  Machine machine = OwnMachine();
  machine.user_effects.clear();
  for (std::uint64_t seed = 1; seed < 4; ++seed) {
    const auto result = ExplainStrokes(
        OwnMachineStrokes({.hidden = {"coulomb"}, .noise = 0.3, .lasting = 0.3, .seed = seed}, machine));
    ASSERT_TRUE(result);
    EXPECT_EQ(result->explanation.verdict, Verdict::kUnknown) << seed;
    EXPECT_FALSE(result->explanation.may_be_noise) << seed;
  }
}

TEST(OwnMachines, AnEffectThatWasAddedWronglyIsReplaced) {
  const ExplainResult result = Explained({.hidden = {"pressure_squared"}, .seed = 2}, {"pressure"});
  ASSERT_TRUE(result.explanation.swap.has_value());
  EXPECT_EQ(result.explanation.swap->out, "pressure");
  EXPECT_THAT(result.explanation.swap->in, UnorderedElementsAre("pressure_squared"));
  EXPECT_LE(result.explanation.swap->rms_after, result.explanation.swap->rms_before);
  EXPECT_THAT(ExplainText(result), HasSubstr("Replace pressure by pressure_squared: error"));
}

TEST(OwnMachines, AnEffectThatIsThereIsNotReplaced) {
  const ExplainResult result = Explained({.hidden = {"pressure", "viscous"}, .seed = 2}, {"pressure"});
  EXPECT_FALSE(result.explanation.swap.has_value());
  EXPECT_THAT(result.explanation.set, UnorderedElementsAre("viscous"));
}

}  // namespace
}  // namespace hydroscope
