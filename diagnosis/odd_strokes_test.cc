#include "diagnosis/odd_strokes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "diagnosis/sample_grams.h"
#include "diagnosis/simulated_log_fixture.h"

namespace hydroscope {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

SimulatedStrokes LogWith(std::vector<ImperfectionSetting> imperfections) {
  PressOptions options;
  options.seconds = 90;
  options.seed = 3;
  options.imperfections = std::move(imperfections);
  return StrokesOfPress(options);
}

Explanation Explained(const SimulatedStrokes& log) {
  return ExplainSamples(log.model, log.strokes, log.window, {});
}

TEST(OddStrokes, AHealthyLogHasNone) {
  const Explanation x = Explained(LogWith({}));
  EXPECT_EQ(x.verdict, Verdict::kAdequate);
  EXPECT_THAT(x.odd_strokes, IsEmpty());
}

TEST(OddStrokes, ALeakInSomeStrokesIsNamedInThese) {
  const Explanation x = Explained(LogWith({{"intermittent_leakage", 8e-12, {{"share", 0.3}}, {}}}));
  ASSERT_THAT(x.odd_strokes, SizeIs(1));
  EXPECT_THAT(x.odd_strokes.front().set, ElementsAre("internal_leakage"));
  EXPECT_GE(x.odd_strokes.front().strokes.size(), 3u);
  EXPECT_EQ(x.verdict, Verdict::kNamed);
}

/// Where the pressure stands still a large leak bends the fit of all so that healthy strokes look the worst.
TEST(OddStrokes, AreFoundWhereTheFitOfAllIsTheirs) {
  PressOptions options = RandomMachine(4);
  options.seconds = 70;
  options.imperfections = {{"calm_pressure", 1, {}, ""}};
  SimulatedStrokes log = StrokesOfPress(options);
  options.effects = {{"internal_leakage", 4e-11, {}}};
  const SimulatedStrokes leaking = StrokesOfPress(options);
  const std::vector<std::size_t> odd = {2, 3, 8, 9};
  for (const std::size_t s : odd) log.strokes.at(s) = leaking.strokes.at(s);
  const StrokeSet strokes(log.model, GramsOf(log.model, log.strokes, log.window), log.window);
  EXPECT_EQ(FindOddStrokes(strokes, {}, {}), odd);
  OddStrokeOptions no_draws;
  no_draws.draws = 0;
  EXPECT_THAT(FindOddStrokes(strokes, {}, {}, no_draws), IsEmpty());
}

TEST(OddStrokes, AnotherFlowGainInSomeIsNoEffectThatImitatesIt) {
  const Explanation x = Explained(LogWith({{"Q_vn_step", 0.03, {{"until", 0.3}}, {}}}));
  ASSERT_THAT(x.odd_strokes, SizeIs(1));
  EXPECT_EQ(x.odd_strokes.front().parameter, "Q_vn");
  EXPECT_THAT(x.odd_strokes.front().set, IsEmpty());
  EXPECT_THAT(x.set, IsEmpty());
}

TEST(OddStrokes, UnderColouredNoiseTheirGainsCountAsThoseOfTheWholeLog) {
  const SimulatedStrokes log = LogWith(
      {{"intermittent_leakage", 12e-12, {{"share", 0.3}}, {}}, {"coloured_noise", 0.5, {{"phi", 0.9}}, {}}});
  ExplainOptions options;
  options.floor_believable = options.noise_is_white = false;
  const Explanation x = ExplainSamples(log.model, log.strokes, log.window, options);
  ASSERT_THAT(x.odd_strokes, Not(IsEmpty()));
  EXPECT_GT(x.evidence_scale, 1.1);
}

TEST(OddStrokes, ManyThatAreScatteredAndWithoutACauseAreNoAllClear) {
  const SimulatedStrokes log = LogWith({{"intermittent_leakage", 8e-12, {{"share", 0.3}}, {}}});
  ExplainOptions options;
  for (const auto* effects : {&log.model->effects, &log.model->sample_effects})
    for (const auto& effect : *effects) options.exclude.push_back(effect->id);
  const Explanation x = ExplainSamples(log.model, log.strokes, log.window, options);
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
}

TEST(OddStrokes, ManyThatAreScatteredAndWithoutACauseLeaveNoNameProven) {
  PressOptions options;
  options.seconds = 90;
  options.seed = 3;
  options.effects = {{"tank_back_pressure", 3e11, {}}};
  options.imperfections = {{"intermittent_leakage", 8e-12, {{"share", 0.3}}, {}}};
  const SimulatedStrokes log = StrokesOfPress(options);
  ExplainOptions only;
  for (const auto* effects : {&log.model->effects, &log.model->sample_effects})
    for (const auto& effect : *effects)
      if (effect->id != "tank_back_pressure") only.exclude.push_back(effect->id);
  const Explanation x = ExplainSamples(log.model, log.strokes, log.window, only);
  EXPECT_THAT(x.set, ElementsAre("tank_back_pressure"));
  ASSERT_THAT(x.odd_strokes, Not(IsEmpty()));
  EXPECT_TRUE(x.partial);
}

/// More than four tenths of the strokes: none of them look odd, but from one on they are.
TEST(OddStrokes, AfterAChangeMayBeMost) {
  const Explanation leaks =
      Explained(LogWith({{"leaky_stretch", 8e-12, {{"begin", 0.4}, {"length", 1}}, {}}}));
  ASSERT_THAT(leaks.odd_strokes, Not(IsEmpty()));
  EXPECT_THAT(leaks.odd_strokes.front().set, ElementsAre("internal_leakage"));
  EXPECT_GE(leaks.odd_strokes.front().strokes.size(), 8u);

  const Explanation reads_high =
      Explained(LogWith({{"bad_stretch", 4e5, {{"begin", 0.5}, {"length", 1}}, {}}}));
  ASSERT_THAT(reads_high.odd_strokes, Not(IsEmpty()));
  EXPECT_THAT(reads_high.odd_strokes.front().set, IsSupersetOf({"pressure_offset", "tank_pressure"}));
}

/// A sensor that reads higher from one stroke on is none whose zero moves, in all strokes but for some. In the first log a law without
/// a name does as well, but leaves no strokes without a cause, as the zero that moves does.
TEST(OddStrokes, OneChangeTakesThePlaceOfANameInDoubt) {
  for (const auto& [machine, seed, begin, size, in_doubt] : {std::tuple{284, 87, 0.31, 3e5, true},
                                                             {14, 49, 0.6, 2e5, false},
                                                             {341, 90, 0.27, 8e5, false},
                                                             {69, 33, 0.55, 2e5, false}}) {
    const PressOptions drawn = RandomMachine(machine);
    PressOptions options;
    options.machine = drawn.machine;
    options.motion = drawn.motion;
    options.seconds = 90;
    options.seed = seed;
    options.oil_start = 305.15;
    options.oil_end = 317.15;
    options.imperfections = {{"bad_stretch", size, {{"begin", begin}, {"length", 1}}, {}}};
    const Explanation x = Explained(StrokesOfPress(options));
    ASSERT_THAT(x.odd_strokes, Not(IsEmpty())) << machine;
    EXPECT_THAT(x.odd_strokes.front().set, IsSupersetOf({"pressure_offset", "tank_pressure"})) << machine;
    EXPECT_EQ(x.partial, in_doubt) << machine;
  }
}

TEST(OddStrokes, ABadStretchOfASensorSpoilsNoOtherStroke) {
  const SimulatedStrokes log = LogWith({{"bad_stretch", 10e5, {{"begin", 0.45}, {"length", 0.12}}, {}}});
  const Explanation x = Explained(log);
  ASSERT_THAT(x.odd_strokes, SizeIs(1));
  EXPECT_THAT(x.odd_strokes.front().set, UnorderedElementsAre("pressure_offset", "tank_pressure"));
  EXPECT_LE(x.odd_strokes.front().strokes.size(), 3u);
  const Eigen::Vector4d truth = StrokesOfPress(PressOptions{}).Fit().theta.head(4);
  EXPECT_NEAR(x.final.theta[0] / truth[0], 1.0, 0.01);
}

/// The root of a shifted pressure is no shifted root: at the small shift that all strokes together imply it does not suit the odd.
TEST(OddStrokes, ALawTiedToItsSizeHasTheSizeOfTheOddStrokes) {
  PressOptions options = RandomMachine(8);
  options.seconds = 90;
  options.effects = {{"pressure_offset", 2.5e5, {}}};
  options.imperfections = {{"intermittent_effects", 0.2, {}, ""}};
  const Explanation x = Explained(StrokesOfPress(options));
  ASSERT_THAT(x.odd_strokes, SizeIs(1));
  EXPECT_THAT(x.odd_strokes.front().set, UnorderedElementsAre("pressure_offset", "tank_pressure"));
}

TEST(OddStrokes, ALawThatIsMissingThroughoutMakesNone) {
  PressOptions options;
  options.seconds = 90;
  options.seed = 4;
  options.effects = {{"relief_valve", 2e-11, {{"crack", 150e5}}}};
  const SimulatedStrokes log = StrokesOfPress(options);
  ExplainOptions without;
  without.exclude = {"relief_valve"};
  const Explanation x = ExplainSamples(log.model, log.strokes, log.window, without);
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_THAT(x.odd_strokes, IsEmpty());
}

}  // namespace
}  // namespace hydroscope
