#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>

#include "diagnosis/states/explain_states.h"
#include "diagnosis/states/found_sets.h"
#include "diagnosis/states/general_laws.h"
#include "diagnosis/states/search_sentences.h"
#include "models/machine.h"

namespace hydroscope {
namespace {

constexpr const char* kOscillator = R"toml([log]
hold = "linear"
[signals]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "V" }
[states]
x = { ddt = "v", initial = "estimate" }
v = { ddt = "w0^2*(gain*u - x) - d*v", initial = "estimate" }
[outputs]
y = "x + zero"
[parameters]
gain = { start = 1, min = 0.2, max = 5 }
zero = { start = 0, min = -1, max = 1 }
w0 = { start = 300, min = 100, max = 1000 }
d = { start = 20, min = 1, max = 200 }
[[effect]]
id = "cubic"
adds = { v = "-k3*x^3" }
parameters = { k3 = { start = 1e4, min = 0, max = 1e6 } }
[[effect]]
id = "quadratic"
adds = { v = "-k2*x^2" }
parameters = { k2 = { start = 1e3, min = -1e6, max = 1e6 } }
[[effect]]
id = "drag"
adds = { v = "-q*v*abs(v)" }
parameters = { q = { start = 0.01, min = 0, max = 1 } }
)toml";

struct Spring {
  double w0, d;              ///< 1/s
  double k3, k2;             ///< 1/s2
  double grows;              ///< share of the last row's input that the first row's is
  double k5 = 0;             ///< 1/s2
  double q = 0;              ///< drag
  double stop = 0, gap = 0;  ///< 1/s2, beyond +-gap
  double above = 0;          ///< 1/s2, beyond a half on one side alone
};

/// Rows at 610 Hz under noise of the input to 150 Hz, sensor noise of 0.5 %.
Episode OscillatorLog(const Spring& spring, int rows, unsigned seed) {
  constexpr int kSteps = 16;
  constexpr double kPeriod = 1 / 610.35, kPole = 0.35;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Episode episode;
  episode.signal.resize(rows, 2);
  std::array<double, 3> filtered{};
  for (int row = 0; row < rows; ++row) {
    double value = normal(random);
    for (double& stage : filtered) value = stage += (1 - kPole) * (value - stage);
    episode.time.push_back(kPeriod * row);
    episode.signal(row, 0) = 2 * value * (spring.grows + (1 - spring.grows) * row / rows);
  }
  double x = 0, v = 0;
  const auto push = [&](double at, double speed, double u) {
    return spring.w0 * spring.w0 * (u - at) - spring.d * speed - spring.k3 * at * at * at -
           spring.k2 * at * at - spring.k5 * std::pow(at, 5) - spring.q * speed * std::abs(speed) -
           spring.stop * (at - std::clamp(at, -spring.gap, spring.gap)) -
           spring.above * std::max(at - 0.5, 0.0);
  };
  for (int row = 0; row < rows; ++row) {
    episode.signal(row, 1) = x + 0.006 * normal(random);
    const double u0 = episode.signal(row, 0), u1 = episode.signal(std::min(row + 1, rows - 1), 0);
    for (int k = 0; k < kSteps; ++k) {
      const double h = kPeriod / kSteps, a = u0 + (u1 - u0) * k / kSteps, b = a + (u1 - u0) / kSteps;
      const double v1 = v, p1 = push(x, v, a), v2 = v + h / 2 * p1,
                   p2 = push(x + h / 2 * v1, v2, (a + b) / 2), v3 = v + h / 2 * p2,
                   p3 = push(x + h / 2 * v2, v3, (a + b) / 2), v4 = v + h * p3, p4 = push(x + h * v3, v4, b);
      x += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
      v += h / 6 * (p1 + 2 * p2 + 2 * p3 + p4);
    }
  }
  return episode;
}

StatesExplanation Explained(const Episode& episode, const std::string& file = kOscillator) {
  const auto machine = ParseMachine(file, "oscillator");
  EXPECT_TRUE(machine) << machine.error().text;
  return ExplainStates(*machine, std::span(&episode, 1));
}

/// So hard a spring swings chaotically: two runs that begin a millionth apart part within a thousand rows.
TEST(ExplainStates, NamesASpringThatHardensSoMuchThatNoFreeRunFollows) {
  const StatesExplanation x = Explained(OscillatorLog({525, 25, 1e5, 0, 1}, 1000, 6));
  EXPECT_EQ(x.verdict, Verdict::kNamed);
  EXPECT_EQ(x.set, std::vector<std::string>{"cubic"});
  EXPECT_FALSE(x.runs.empty());
  EXPECT_LT(x.final.fit.noise[0], 0.02);
}

/// What is left of such a spring swings from row to row, and its correlations sum up to no more than those of noise do.
TEST(ExplainStates, TakesWhatSwingsFromRowToRowForNoNoise) {
  const StatesExplanation x = Explained(OscillatorLog({525, 25, 3e5, 0, 1}, 1000, 7));
  EXPECT_EQ(x.verdict, Verdict::kNamed);
  EXPECT_EQ(x.set, std::vector<std::string>{"cubic"});
  EXPECT_LT(x.final.fit.noise[0], 0.02);
}

/// What a wrong minimum of the smaller set leaves is no measure of what another effect would do in its place.
TEST(ExplainStates, ARivalIsAsGoodBesideWhatItsEffectAloneAddsToTheShared) {
  const StatesExplanation x = Explained(OscillatorLog({362, 34, 1e4, 3000, 0.03}, 2700, 7));
  EXPECT_EQ(x.verdict, Verdict::kNamed);
  EXPECT_EQ(x.set, (std::vector<std::string>{"cubic", "quadratic"}));
}

/// A spring that hardens, and a little more to one side: the small law that no file has takes nothing of the large one's name.
TEST(ExplainStates, NamesALawBesideWhichASmallOneIsMissing) {
  std::string file = kOscillator;
  const std::size_t quadratic = file.find("[[effect]]\nid = \"quadratic\""), drag = file.rfind("[[effect]]");
  file.erase(quadratic, drag - quadratic);
  const StatesExplanation x = Explained(OscillatorLog({362, 34, 1e4, 9000, 1}, 1500, 7), file);
  EXPECT_EQ(x.verdict, Verdict::kNamed);
  EXPECT_EQ(x.set, std::vector<std::string>{"cubic"});
  EXPECT_TRUE(x.partial);
  EXPECT_GT(x.unexplained, 0.02);
}

/// A spring that hardens, and a small law on one side that no file has: a square beside the cube takes it up, which is no reason to
/// give the cube's name away.
TEST(ExplainStates, ACubeStandsBesideACubeAndASquareThatTakeUpASmallLaw) {
  std::string file = kOscillator;
  const std::size_t quadratic = file.find("[[effect]]\nid = \"quadratic\""), drag = file.rfind("[[effect]]");
  file.replace(quadratic, drag - quadratic, R"toml([[effect]]
id = "uneven"
adds = { v = "-k2*x^2 - k3*x^3" }
parameters = { k2 = { start = 1e3, min = -1e6, max = 1e6 }, k3 = { start = 1e4, min = 0, max = 1e6 } }
)toml");
  Spring spring{362, 34, 1e4, 0, 1};
  spring.above = 1500;
  const StatesExplanation x = Explained(OscillatorLog(spring, 1500, 7), file);
  EXPECT_THAT(x.set, testing::UnorderedElementsAre("cubic", "uneven"));
  EXPECT_EQ(x.verdict, Verdict::kAmbiguous);
}

/// A file with a stop in place of the spring that hardens; `adds`: to further equations.
std::string WithStop(const std::string& adds = "") {
  constexpr const char* kStop = R"toml([[effect]]
id = "stop"
adds = {{ v = "-k_s*(max(x - g, 0) - max(-x - g, 0))"{} }}
parameters = {{ k_s = {{ start = 1e4, min = 0, max = 1e6 }}, g = {{ start = 1, min = 0.1, max = 4 }} }}
)toml";
  std::string file = kOscillator;
  const std::size_t cubic = file.find("[[effect]]");
  return file.replace(cubic, file.find("[[effect]]", cubic + 1) - cubic, fmt::format(kStop, adds));
}

TEST(ExplainStates, LawsOfGeneralShapeReadGermanInGermanSentences) {
  int words = 0;
  for (const GeneralShape& shape : GeneralShapes("u")) {
    const Told told = NotToldFromGeneral("stop", {"law", {"v"}, shape.formula});
    EXPECT_THAT(told.german, testing::Not(testing::ContainsRegex("what|some|step"))) << told.english;
    words += shape.formula.InGerman() != shape.formula.english;
  }
  EXPECT_EQ(words, 4) << "the others are formulas";
}

/// That a cube would do better than the stop.
bool ToldOfACube(const StatesExplanation& x, const std::string& equations) {
  return std::ranges::any_of(x.warnings, [&](const Told& warning) {
    return warning.english.starts_with("x^3 in the equation of " + equations + ",");
  });
}

/// Of the effects of the file a stop comes nearest to a spring that hardens: a cube in its place, which no effect is, does better.
TEST(ExplainStates, AStopIsNotNamedForASpringThatIsNotInTheFile) {
  const StatesExplanation x = Explained(OscillatorLog({362, 34, 1e3, 0, 1}, 1500, 7), WithStop());
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_EQ(x.nearest, std::vector<std::string>{"stop"});
  EXPECT_TRUE(ToldOfACube(x, "v"));
}

TEST(ExplainStates, AStopThatBendsItsSensorIsNotNamedForThatSpringEither) {
  const StatesExplanation x = Explained(OscillatorLog({362, 34, 1e3, 0, 1}, 1500, 7),
                                        WithStop(", y = \"1e-9*k_s*(max(x - g, 0) - max(-x - g, 0))\""));
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_EQ(x.nearest, std::vector<std::string>{"stop"});
  EXPECT_TRUE(ToldOfACube(x, "v"));
}

TEST(ExplainStates, AStopBesideTheRightEffectIsNotNamedForASpringThatIsNotInTheFile) {
  const StatesExplanation x = Explained(OscillatorLog({362, 34, 300, 0, 1, 0, 0.1}, 1500, 7), WithStop());
  EXPECT_EQ(x.set, std::vector<std::string>{"drag"});
  EXPECT_EQ(x.nearest, std::vector<std::string>{"stop"});
  EXPECT_TRUE(ToldOfACube(x, "v"));
}

/// Nothing follows this spring for long, neither the stop nor, over 50 rows, anything else in the file.
TEST(ExplainStates, AStopIsNotNamedForASpringThatNoFreeRunFollows) {
  const StatesExplanation x = Explained(OscillatorLog({484, 54, 0, 0, 0.02, 1e5}, 2000, 8), WithStop());
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_TRUE(x.set.empty());
}

/// A search of one log that has found a set of effects.
struct FoundEffects {
  FoundEffects(const std::string& file, Episode log, const std::vector<std::string>& set, int contenders)
      : machine(*ParseMachine(file, "oscillator")), episode(std::move(log)) {
    options.contenders = contenders;
    found.emplace(machine, std::span(&episode, 1), 1, options);
    found->out.base = Fitted({});
    found->out.final_left.structured = true;
    found->fits.emplace(machine, found->episodes, found->starts_on, options, found->out.base);
    found->out.final = found->fits->Without(Fitted(set), set);  // over the noise of the base
  }
  StateCandidate Fitted(const std::vector<std::string>& added) const {
    StateCandidate out{added, FitStates(*BuildStateModel(machine, added), found->episodes), 0};
    out.held_out = out.fit.HeldOutEnergy();
    return out;
  }

  Machine machine;
  Episode episode;
  ExplainStatesOptions options;
  std::optional<FoundSets> found;
};

/// A stop found in place of a fifth power, about whose absence linearisation promises nothing of any law.
TEST(GeneralLaws, ThoseNearestToWhatWasFoundAreTriedWhateverLinearisationPromises) {
  FoundEffects stop(WithStop(), OscillatorLog({362, 34, 0, 0, 1, 100}, 800, 7), {"stop"}, 0);
  const auto told = BetterGeneralLaw(*stop.found, "stop");
  ASSERT_TRUE(told);
  EXPECT_THAT(told->english, testing::HasSubstr("x^5 in the equation of v"));
}

/// A cube and a square imitate a fifth power, and one law does better; of a true cube and square none alone does.
TEST(GeneralLaws, OneInPlaceOfAWholeSetIsToldWhereItAloneDoesAsWell) {
  constexpr int kRows = 500;
  const std::vector<std::string> set = {"cubic", "quadratic"};
  FoundEffects imitate(kOscillator, OscillatorLog({362, 34, 0, 0, 1, 100}, kRows, 7), set, 1);
  EXPECT_TRUE(GeneralLawInPlaceOfAll(*imitate.found));
  FoundEffects hold(kOscillator, OscillatorLog({362, 34, 1e4, 3000, 0.03}, kRows, 7), set, 1);
  EXPECT_FALSE(GeneralLawInPlaceOfAll(*hold.found));
}

/// A cube is the nearest there is to soft stops on both sides.
TEST(ExplainStates, ACubeIsNotNamedForStopsThatAreNotInTheFile) {
  for (const double stop : {1.5e4, 5e4}) {
    const StatesExplanation x = Explained(OscillatorLog({362, 34, 0, 0, 1, 0, 0, stop, 3}, 1500, 7));
    EXPECT_EQ(x.verdict, Verdict::kUnknown) << stop;
    EXPECT_TRUE(x.set.empty()) << stop;
  }
}

/// A cube is the nearest there is to a fifth power.
TEST(ExplainStates, ACubeIsNotNamedForAFifthPowerThatIsNotInTheFile) {
  for (const double k5 : {100.0, 600.0}) {
    const StatesExplanation x = Explained(OscillatorLog({362, 34, 0, 0, 1, k5}, 1500, 7));
    EXPECT_EQ(x.verdict, Verdict::kUnknown) << k5;
    EXPECT_TRUE(x.set.empty()) << k5;
  }
}

}  // namespace
}  // namespace hydroscope
