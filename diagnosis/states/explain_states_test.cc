#include "diagnosis/states/explain_states.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <mutex>
#include <numbers>
#include <random>

#include "diagnosis/states/missing_law.h"
#include "diagnosis/states/search_conclusion.h"
#include "models/machine.h"

namespace hydroscope {
namespace {

/// A cylinder moves as its valve opens, back by itself with the rate `back`; what else pushes it is not measured.
constexpr const char* kPushedCylinder = R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "1" }
y = { column = "y", unit = "m" }
[states]
x = { ddt = "k*u - back*x", initial = "estimate", unit = "m" }
[outputs]
y = "x"
[parameters]
k = { start = 1, min = 0.1, max = 10, unit = "m/s" }
[geometry]
back = { value = BACK, unit = "1/s" }
[[effect]]
id = "bent_valve"
adds = { x = "c*u*abs(u)" }
parameters = { c = { start = 0.1, min = 0, max = 2, unit = "m/s" } }
[[effect]]
id = "dead_zone"
adds = { x = "-k*max(min(u, d), -d)" }
parameters = { d = { start = 0.05, min = 0, max = 0.5 } }
)toml";

/// What the valve passes beyond in proportion, m/s.
using ValveLaw = double (*)(double opening);
double Bent(double u) { return 0.3 * u * std::abs(u); }
double Even(double) { return 0; }
double Wavy(double u) { return 0.2 * std::sin(9 * u); }

struct Pushed {
  double push = 0;       ///< m per row, at random
  double back = 0;       ///< 1/s
  double sensor = 2e-4;  ///< m, noise of the sensor
};

/// Rows of 10 ms under a valve that opens at several frequencies.
Episode PushedLog(ValveLaw law, const Pushed& pushed) {
  constexpr int kRows = 3000;
  constexpr double kPeriod = 0.01;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Episode episode;
  episode.signal.resize(kRows, 2);
  double x = 0;
  for (int row = 0; row < kRows; ++row) {
    const double t = kPeriod * row;
    double u = 0;
    for (const double hertz : {0.7, 1.9, 3.1}) u += 0.4 * std::sin(2 * std::numbers::pi * hertz * t + hertz);
    episode.time.push_back(t);
    episode.signal(row, 0) = u;
    episode.signal(row, 1) = x + pushed.sensor * normal(random);
    x += kPeriod * (u + law(u) - pushed.back * x) + pushed.push * normal(random);
  }
  return episode;
}

Machine PushedMachine(std::string text, double back) {
  text.replace(text.find("BACK"), 4, fmt::to_string(back));
  const auto machine = ParseMachine(text, "cylinder");
  EXPECT_TRUE(machine) << machine.error().text;
  return *machine;
}

StatesExplanation ExplainPushed(ValveLaw law, const Pushed& pushed) {
  const Episode episode = PushedLog(law, pushed);
  return ExplainStates(PushedMachine(kPushedCylinder, pushed.back), std::span(&episode, 1));
}

TEST(ExplainStates, NamesWhatNoiseOfTheProcessCoversOverAWholeEpisode) {
  const StatesExplanation x = ExplainPushed(Bent, {.push = 1e-3});
  EXPECT_EQ(x.verdict, Verdict::kNamed);
  EXPECT_EQ(x.set, std::vector<std::string>{"bent_valve"});
  EXPECT_FALSE(x.runs.empty());
}

TEST(ExplainStates, FindsNothingInNoiseOfTheProcessAlone) {
  const StatesExplanation x = ExplainPushed(Even, {.push = 1e-3});
  EXPECT_EQ(x.verdict, Verdict::kAdequate);
  EXPECT_FALSE(x.runs.empty());
}

/// What acts while nothing is read shows afterwards alone, where each short run begins anew.
TEST(ExplainStates, ShortRunsAreNoAllClearWhereAnOutputHasNoReadingsForLong) {
  Episode episode = PushedLog(Even, {.push = 1e-3});
  for (const int first : {500, 1300, 2100}) episode.signal.col(1).segment(first, 200).setConstant(NAN);
  const Machine machine = PushedMachine(kPushedCylinder, 0);
  const StatesExplanation x = ExplainStates(machine, std::span(&episode, 1));
  EXPECT_FALSE(x.runs.empty());
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_TRUE(x.only_doubtful());
  ExplainStatesOptions sees_all;
  sees_all.blind_share = 2;
  EXPECT_EQ(ExplainStates(machine, std::span(&episode, 1), sees_all).verdict, Verdict::kAdequate);
}

TEST(ExplainStates, CallsALawThatIsNotInTheFileUnknownInShortRunsToo) {
  const StatesExplanation x = ExplainPushed(Wavy, {.push = 1e-3});
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_FALSE(x.runs.empty());
}

TEST(ExplainStates, RunsOverWholeEpisodesWhereNothingActsOnTheProcess) {
  const StatesExplanation x = ExplainPushed(Bent, {});
  EXPECT_EQ(x.set, std::vector<std::string>{"bent_valve"});
  EXPECT_TRUE(x.runs.empty());
}

TEST(ExplainStates, FindsTheSameOnSeveralThreadsAndTellsWhatItDoes) {
  const Episode episode = PushedLog(Wavy, {.back = 2});
  const Machine machine = PushedMachine(kPushedCylinder, 2);
  std::mutex mutex;
  std::vector<std::string> told;
  ExplainStatesOptions options;
  const StatesExplanation alone = ExplainStates(machine, std::span(&episode, 1), options);
  options.threads = 4;
  options.tells = [&](const std::string& what) {
    const std::lock_guard lock(mutex);
    told.push_back(what);
  };
  const StatesExplanation several = ExplainStates(machine, std::span(&episode, 1), options);
  EXPECT_EQ(several.verdict, alone.verdict);
  EXPECT_EQ(several.set, alone.set);
  EXPECT_EQ(several.nearest, alone.nearest);
  EXPECT_EQ(several.warnings, alone.warnings);
  ASSERT_EQ(several.ranking.size(), 2u);
  ASSERT_EQ(alone.ranking.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(several.ranking[k].added, alone.ranking[k].added);
    EXPECT_EQ(several.ranking[k].held_out, alone.ranking[k].held_out);
    EXPECT_EQ(several.ranking[k].fit.parameters, alone.ranking[k].fit.parameters);
  }
  EXPECT_THAT(told, testing::Contains("fits the model as it is, start 1 of at most 9"));
  EXPECT_THAT(told, testing::Contains("all effects: 2 of 2"));
}

TEST(ExplainStates, SaysWhichEffectsAnEpisodeCannotShow) {
  const Machine machine = PushedMachine(std::string(kPushedCylinder) + R"toml([[effect]]
id = "end_stop"
adds = { x = "-c*max(x - far, 0)" }
parameters = { c = { start = 1, min = 0.1, max = 10, unit = "1/s" }, far = { start = 20, min = 10, max = 30, unit = "m" } }
[[effect]]
id = "wider_valve"
adds = { x = "more*u" }
parameters = { more = { start = 0.1, min = 0, max = 1, unit = "m/s" } }
)toml",
                                        0);
  const Episode episode = PushedLog(Even, {});
  const StatesExplanation x = ExplainStates(machine, std::span(&episode, 1));
  const std::map<std::string, EffectSeen> expected = {{"end_stop", EffectSeen::kNeverActs},
                                                      {"wider_valve", EffectSeen::kTakenOver}};
  EXPECT_EQ(x.not_seen, expected);
}

double Rising(double) { return 0.1; }

/// A stop that the model as it is never reaches is reached about the set found.
TEST(ExplainStates, WhatIsSeenAboutTheSetFoundIsNotCalledUnseen) {
  const Machine machine = PushedMachine(std::string(kPushedCylinder) + R"toml([[effect]]
id = "inflow"
adds = { x = "rise" }
parameters = { rise = { start = 0.01, min = 0, max = 1, unit = "m/s" } }
[[effect]]
id = "end_stop"
adds = { x = "-c*max(x - far, 0)" }
parameters = { c = { start = 1, min = 0.1, max = 10, unit = "1/s" }, far = { start = 2.5, min = 2, max = 2.8, unit = "m" } }
)toml",
                                        0);
  const Episode episode = PushedLog(Rising, {});
  const StatesExplanation x = ExplainStates(machine, std::span(&episode, 1));
  EXPECT_EQ(x.set, std::vector<std::string>{"inflow"});
  EXPECT_FALSE(x.not_seen.contains("end_stop"));
}

double BentWithSteep(double u) { return 0.8 * u * std::abs(u) - 0.06 * std::tanh(12 * u); }

/// A small law beside the one that is found has the shape of nothing in the file: what comes near to it is not named.
TEST(ExplainStates, WhatStandsInForASmallLawBesideTheOneFoundIsNotNamed) {
  const Machine machine = PushedMachine(std::string(kPushedCylinder) + R"toml([[effect]]
id = "round_edge"
adds = { x = "e*tanh(3*u)" }
parameters = { e = { start = 0, min = -1, max = 1, unit = "m/s" } }
)toml",
                                        0);
  const Episode episode = PushedLog(BentWithSteep, {});
  const StatesExplanation x = ExplainStates(machine, std::span(&episode, 1));
  EXPECT_EQ(x.set, std::vector<std::string>{"bent_valve"});
  EXPECT_TRUE(x.partial);
  EXPECT_FALSE(x.nearest.empty());
  // The staircase ends at the set found, without what was dropped from it.
  EXPECT_EQ(x.final.added, x.set);
  ASSERT_EQ(x.steps.size(), 2u);
  EXPECT_EQ(x.steps.back().first, "bent_valve");
}

double WavyAndALittleBent(double u) { return 0.2 * std::sin(9 * u) + 0.65 * u * std::abs(u); }

/// Too little of the error to be taken, beside a law that nobody has named.
TEST(ExplainStates, WhatTakesAPartAwayIsToldAsNearestThoughItIsTooLittleToBeTaken) {
  const StatesExplanation x = ExplainPushed(WavyAndALittleBent, {.back = 30, .sensor = 2e-3});
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_TRUE(x.final.added.empty());
  EXPECT_EQ(x.nearest, std::vector<std::string>{"bent_valve"});
  EXPECT_TRUE(x.partial);
}

/// A law of nearly the same shape does hardly less: which of the two is nearer the log does not say.
TEST(ExplainStates, WhatDoesHardlyLessIsToldBesideTheNearest) {
  const Machine machine = PushedMachine(std::string(kPushedCylinder) + R"toml([[effect]]
id = "softly_bent_valve"
adds = { x = "c*u*sqrt(u^2 + 0.01)" }
parameters = { c = { start = 0.1, min = 0, max = 2, unit = "m/s" } }
)toml",
                                        30);
  const Episode episode = PushedLog(WavyAndALittleBent, {.back = 30, .sensor = 2e-3});
  const StatesExplanation x = ExplainStates(machine, std::span(&episode, 1));
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_THAT(x.nearest, testing::UnorderedElementsAre("bent_valve", "softly_bent_valve"));
}

/// The law less the straight line that the valve's gain takes over, where the file names no effect.
TEST(ExplainStates, ShowsTheShapeOfALawThatNobodyHasNamed) {
  const std::string_view all = kPushedCylinder;
  const Machine machine = PushedMachine(std::string(all.substr(0, all.find("[[effect]]"))), 0);
  const Episode episode = PushedLog(Bent, {});
  const StatesExplanation x = ExplainStates(machine, std::span(&episode, 1));
  ASSERT_EQ(x.verdict, Verdict::kUnknown);
  ASSERT_EQ(x.final_left.about, "x");
  const auto law = FindMissingLaw(x.final.fit, std::span(&episode, 1), x.final_left.about);
  ASSERT_TRUE(law);
  EXPECT_TRUE(law->of_state);
  EXPECT_EQ(law->variable, "u");
  EXPECT_GT(law->share, 0.8);
  const auto count = static_cast<Eigen::Index>(law->points.size());
  Eigen::MatrixXd line(count, 2);
  Eigen::VectorXd truth(count), curve(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const MissingLaw::Point& point = law->points[static_cast<std::size_t>(k)];
    line.row(k) << 1, point.x;
    truth[k] = Bent(point.x);
    curve[k] = point.value;
  }
  truth -= line * line.colPivHouseholderQr().solve(truth);
  EXPECT_LT((curve - truth).norm(), 0.3 * truth.norm()) << curve.transpose() << "\n" << truth.transpose();
  // Of the right law nothing is left to be shown.
  const Episode even = PushedLog(Even, {});
  const StatesExplanation healthy = ExplainStates(machine, std::span(&even, 1));
  EXPECT_FALSE(FindMissingLaw(healthy.final.fit, std::span(&even, 1), "x"));
}

/// What pushes the cylinder is forgotten within ten rows, and no run is so short that it does not cover what the valve does.
constexpr double kBackFast = 10;

TEST(ExplainStates, GivesNoVerdictOfAFreeRunThatHardlyFollows) {
  const StatesExplanation x = ExplainPushed(Even, {.push = 0.1, .back = kBackFast});
  EXPECT_GT(x.final.fit.ErrorOfVariation(), kHardlyFollows);
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_TRUE(x.astray);
}

TEST(ExplainStates, AFreeRunUnderMuchWhiteNoiseFollowsNonetheless) {
  const StatesExplanation x = ExplainPushed(Even, {.back = kBackFast, .sensor = 0.1});
  EXPECT_GT(x.final.fit.ErrorOfVariation(), kHardlyFollows);
  EXPECT_EQ(x.verdict, Verdict::kAdequate);
  EXPECT_FALSE(x.astray);
}

/// What is left of the sizes given: noise that an autoregression colours (0: white).
StatesExplanation Leaving(double colour, double before, double after) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  StatesExplanation x;
  RowMatrix residual(3000, 1);
  double noise = 0;
  for (Eigen::Index row = 0; row < residual.rows(); ++row)
    residual(row, 0) = noise = colour * noise + std::sqrt(1 - colour * colour) * normal(random);
  x.final.fit.residuals = {residual};
  x.final.fit.noise = Eigen::VectorXd::Constant(1, residual.norm() / std::sqrt(3000.0));
  x.base.held_out = before;
  x.final.held_out = after;
  return x;
}

TEST(ExplainStates, WhatIsLeftThatLastsIsHeldAgainstWhatIsExplained) {
  EXPECT_EQ(Leaving(0, 5000, 3000).SlowShare(), 0);
  EXPECT_EQ(Leaving(0.6, 5000, 3000).SlowShare(), 0);  // a filter of a converter
  StatesExplanation x = Leaving(0.98, 5000, 3000);
  EXPECT_NEAR(x.SlowShare(), 0.96 * 3000 / 2000, 0.03);
  EXPECT_LT(Leaving(0.98, 9000, 3000).SlowShare(), 1);
  x.final_left.structured = true;
  EXPECT_EQ(x.SlowShare(), 0);
}

TEST(ShortRuns, TellWhatWholeEpisodesSaidUnlessTheySayItToo) {
  const std::vector<Told> of_whole = {{"a law is missing", "ein Gesetz fehlt"},
                                      {"the sensor ends", "der Sensor endet"}};
  std::vector<Told> told = {{"the sensor ends", "der Sensor endet"}};
  AddOverWhole(of_whole, told);
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[1], Told("over whole episodes: a law is missing", "über ganze Episoden: ein Gesetz fehlt"));
}

}  // namespace
}  // namespace hydroscope
