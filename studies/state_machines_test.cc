#include "studies/state_machines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "diagnosis/states/held_out_run.h"
#include "workbench/states/states_output.h"
#include "workbench/states/states_warnings.h"

namespace hydroscope {
namespace {

StateMachineOutcome OutcomeOf(int seed, int number) {
  StateMachinesOptions options;
  options.seed = static_cast<std::uint64_t>(seed);
  return RunCase(number, options);
}

/// The hidden effect of the case is named first; the next log then errs by at most `worst` times its noise.
void ExpectNamed(int seed, int number, double worst = std::numeric_limits<double>::infinity()) {
  const StateMachineOutcome outcome = OutcomeOf(seed, number);
  EXPECT_EQ(outcome.score.first, 1) << outcome.line;
  EXPECT_LT(outcome.score.worst_ratio, worst) << outcome.line;
}

void ExpectUnknown(int seed, int number) {
  const StateMachineOutcome outcome = OutcomeOf(seed, number);
  EXPECT_EQ(outcome.score.unknown, 1) << outcome.line;
}

StatesExplanation ExplainOf(StateMachineKind kind, const std::string& hidden, const std::string& without = {},
                            std::uint64_t seed = 6) {
  const Machine machine = StatesMachine(kind, without);
  const Episode episode = EpisodeOf(SimulateStates({kind, hidden, seed, 1000}), machine);
  return ExplainStates(machine, std::span(&episode, 1));
}

TEST(StateMachines, TheSpringThatIsHiddenIsNamed) {
  const StatesExplanation x = ExplainOf(StateMachineKind::kOscillator, "cubic");
  EXPECT_EQ(x.verdict, Verdict::kNamed);
  EXPECT_EQ(x.set, std::vector<std::string>{"cubic"});
  EXPECT_LT(x.final.held_out, 0.05 * x.base.held_out);
}

TEST(StateMachines, TheSpringThatNobodyThoughtOfIsUnknown) {
  EXPECT_EQ(ExplainOf(StateMachineKind::kOscillator, "cubic", "cubic").verdict, Verdict::kUnknown);
}

TEST(StateMachines, ATankThatOverflowsUnseenIsNamedAndAHealthyOneAdequate) {
  const StatesExplanation x = ExplainOf(StateMachineKind::kTanks, "overflow");
  EXPECT_EQ(x.verdict, Verdict::kNamed);
  EXPECT_EQ(x.set, std::vector<std::string>{"overflow"});
  EXPECT_EQ(ExplainOf(StateMachineKind::kTanks, "").verdict, Verdict::kAdequate);
}

TEST(StateMachines, TheStaircaseIsInTheMeasureOfTheFitsWhereOutputsAreSeveral) {
  const StatesExplanation x = ExplainOf(StateMachineKind::kActuator, "root_flow");
  ASSERT_EQ(x.set, std::vector<std::string>{"root_flow"});
  const auto share = [](const StateFit& fit) {
    return std::sqrt(fit.noise.cwiseQuotient(fit.scale).squaredNorm() / 2);
  };
  EXPECT_NEAR(x.steps.front().second, share(x.base.fit), 0.05 * share(x.base.fit));
  EXPECT_NEAR(x.steps.back().second, share(x.final.fit), 0.05 * share(x.final.fit));
}

/// A hardening oscillator whose next log no free run follows to the end, and one whose next log it does.
TEST(StateMachines, ANextLogInWhichTheRunLosesItsWayIsToldFromOneThatRefutesTheModel) {
  StateMachinesOptions options;
  options.seed = 60613;
  for (const int number : {192, 0}) {
    const StateMachineCase one = CaseNumber(number, options);
    ASSERT_EQ(one.simulated.kind, StateMachineKind::kOscillator);
    const Machine machine = StatesMachine(one.simulated.kind, "");
    SimulatedStates longer = one.simulated;
    longer.rows *= 2;
    const Episode whole = EpisodeOf(SimulateStates(longer), machine);
    const int rows = one.simulated.rows;
    const Episode fitted{0, 0, {whole.time.begin(), whole.time.begin() + rows}, whole.signal.topRows(rows)},
        next{0, rows, {whole.time.begin() + rows, whole.time.end()}, whole.signal.bottomRows(rows)};
    const auto model = BuildStateModel(machine, {one.simulated.hidden});
    ASSERT_TRUE(model) << model.error().text;
    const StateFit fit = FitStates(*model, std::span(&fitted, 1));
    ASSERT_TRUE(fit.solved()) << fit.failed.english;
    const StateFit followed = FollowStates(*model, std::span(&next, 1), fit.parameters, fit.noise);
    ASSERT_TRUE(followed.solved()) << followed.failed.english;
    const HeldOutRun run = LookAtHeldOut(fit, std::span(&fitted, 1), followed, std::span(&next, 1));
    if (number == 0) {
      EXPECT_LT(run.error, 1.5);
      EXPECT_FALSE(run.loses_its_way);
      EXPECT_TRUE(run.beyond.empty());
      Episode moved = next;  // the zero of a sensor
      moved.signal.col(model->get()->outputs.front()).array() += 5 * fit.noise[0];
      const StateFit off = FollowStates(*model, std::span(&moved, 1), fit.parameters, fit.noise);
      const HeldOutRun said = LookAtHeldOut(fit, std::span(&fitted, 1), off, std::span(&moved, 1));
      ASSERT_EQ(said.constant.size(), 1u);
      EXPECT_NEAR(said.constant[0].by, 5 * fit.noise[0], fit.noise[0]);
      EXPECT_GT(said.constant[0].share, 0.9);
      continue;
    }
    EXPECT_GT(run.error, 1.5);
    EXPECT_LT(run.short_error, 1.1);
    EXPECT_TRUE(run.loses_its_way);
    EXPECT_TRUE(run.constant.empty());
    EXPECT_FALSE(HeldOutTexts(run, **model, "next.csv").empty());
    StateFit wrong = fit;  // a model that is wrong errs over short runs too
    wrong.parameters[2] *= 1.02;
    const StateFit astray = FollowStates(*model, std::span(&next, 1), wrong.parameters, fit.noise);
    EXPECT_FALSE(LookAtHeldOut(wrong, std::span(&fitted, 1), astray, std::span(&next, 1)).loses_its_way);
  }
}

TEST(StateMachines, AMeasuredLogNamesWhatIsHiddenAndItsSensorsEndIsLeftOut) {
  const Machine machine = StatesMachine(StateMachineKind::kActuator, {});
  const Episode episode =
      EpisodeOf(SimulateStates({StateMachineKind::kActuator, "root_flow", 7017, 1448, true}), machine);
  const StatesExplanation x = ExplainStates(machine, std::span(&episode, 1));
  EXPECT_EQ(x.verdict, Verdict::kNamed);
  EXPECT_EQ(x.set, std::vector<std::string>{"root_flow"});
}

TEST(StateMachines, ALongLogIsSearchedInPieces) {
  const Machine machine = StatesMachine(StateMachineKind::kOscillator, "");
  const Episode episode =
      EpisodeOf(SimulateStates({StateMachineKind::kOscillator, "cubic", 6, 6000}), machine);
  ExplainStatesOptions options;
  options.most_rows = 2000;
  options.piece_rows = 500;
  const StatesExplanation x = ExplainStates(machine, std::span(&episode, 1), options);
  EXPECT_EQ(x.set, std::vector<std::string>{"cubic"});
  EXPECT_EQ(x.final.fit.readings(), 6000);
  EXPECT_LT(x.final.held_out, 0.05 * x.base.held_out);
}

/// Healthy, with small laws that no file has and that drag or leak take a part of; overflows that are not in the file, one of them
/// imitated by two effects together, one by a leak in short runs alone, one that spills by one that does not, one by a leak about
/// whose fit little of it shows.
TEST(StateMachines, WhatIsTooSmallOrOnlyImitatedIsNotNamed) {
  for (const auto& [seed, number] : {std::pair(53, 19), {53, 165}, {77123, 115}, {90817, 67}, {771603, 67}}) {
    StateMachinesOptions options;
    options.seed = static_cast<std::uint32_t>(seed);
    const StateMachineOutcome outcome = RunCase(number, options);
    EXPECT_EQ(outcome.score.wrong, 0) << outcome.line;
  }
}

TEST(StateMachines, ALongerLogOfTheSameSeedBeginsWithTheShorter) {
  for (const auto kind :
       {StateMachineKind::kOscillator, StateMachineKind::kTanks, StateMachineKind::kActuator}) {
    const StatesLog one = SimulateStates({kind, "", 4, 1100, true}),
                    longer = SimulateStates({kind, "", 4, 2200, true});
    for (std::size_t row = 0; row < one.input.size(); row += 13) {
      EXPECT_EQ(one.input[row], longer.input[row]);
      if (std::isfinite(one.outputs[0][row])) {
        EXPECT_EQ(one.outputs[0][row], longer.outputs[0][row]);
      }
    }
  }
}

TEST(StateMachines, AnEffectThatOnlyHelpedOutOfAWrongMinimumIsTakenOutAgain) {
  const Machine machine = StatesMachine(StateMachineKind::kTanks, {});
  const Episode episode = EpisodeOf(SimulateStates({StateMachineKind::kTanks, "leak", 31004, 2000}), machine);
  const StatesExplanation x = ExplainStates(machine, std::span(&episode, 1));
  EXPECT_EQ(x.verdict, Verdict::kNamed);
  EXPECT_EQ(x.set, std::vector<std::string>{"leak"}) << "and no overflow";
}

TEST(StateMachines, OfEffectsThatComeToTheSameTheSimplestStands) {
  const Machine machine = StatesMachine(StateMachineKind::kTanks, {});
  const Episode episode =
      EpisodeOf(SimulateStates({StateMachineKind::kTanks, "overflow", 31001, 2000}), machine);
  const StatesExplanation x = ExplainStates(machine, std::span(&episode, 1));
  EXPECT_EQ(x.verdict, Verdict::kNamed) << "spill with a part of 0 is the same law";
  EXPECT_EQ(x.set, std::vector<std::string>{"overflow"});
}

/// The effect that holds the hidden one as a special case had begun nearer to it, and ended there.
TEST(StateMachines, ASpecialCaseStandsThoughItsOwnFitBeganFarOff) { ExpectNamed(89, 1); }

/// The tanks without their spill stood in a minimum about which no effect helped.
TEST(StateMachines, WhereNoEffectHelpsAllAreFittedFromAfar) { ExpectNamed(340127, 112); }

/// Without the one group of pieces in which it spills the parameters run away, which functions undo; what the law leaves is next to
/// nothing of what it explains.
TEST(StateMachines, WhatIsLeftOfNextToNothingIsNoDoubt) { ExpectNamed(90210, 16); }

/// The next log begins with a tank beyond its brim, from where nothing leads back.
TEST(StateMachines, WhatIsNotMeasuredAtTheBeginIsSoughtFromWhereTheModelComesBy) {
  ExpectNamed(5101, 25, 1.1);
}

/// Alone in a wrong minimum the right effect left what a second one, or nothing at all, seemed to be needed for.
TEST(StateMachines, WhatAWrongMinimumLeavesIsNoSecondEffect) {
  for (const auto& [seed, number] : {std::pair(89, 52), std::pair(5101, 48), std::pair(5101, 52)})
    ExpectNamed(seed, number, 1.1);
}

/// Rare large swings of a hardening spring: about the fit without it linearisation foresees next to nothing of its law, and what
/// functions predict is no more than chance may reach.
TEST(StateMachines, WhereWhatIsLeftIsNoWhiteNoiseEffectsAreTriedThatPromiseNothing) {
  ExpectNamed(7411, 168, 1.1);
}

TEST(StateMachines, ALawOutsideTheFileThatNoFunctionPredictsStaysUnknownInShortRuns) {
  ExpectUnknown(901, 7);
}

/// A few spills hold most of the error: chance reaches what functions predict of it in one of twenty logs, and yet it is no all-clear.
TEST(StateMachines, ARareLawOutsideTheFileLeavesNoAllClear) { ExpectUnknown(61, 31); }

TEST(StateMachines, AnEffectThatActsSlowlyIsNamedThoughShortRunsShowNothing) { ExpectNamed(6203, 136); }

TEST(StateMachines, TheNextLogIsFollowedFromWhereverItBegins) {
  StateMachinesOptions options;
  options.seed = 89;
  // A hardening spring in full swing at the first row.
  const StateMachineOutcome outcome = RunCase(48, options);
  EXPECT_GT(outcome.score.worst_ratio, 0) << outcome.line;
  EXPECT_LT(outcome.score.worst_ratio, 1.1) << outcome.line;
}

/// The example of docs/state_models.md: the indented lines before the commands.
std::string ExampleOfTheDocs() {
  std::ifstream file(std::string(HYDROSCOPE_SOURCE_DIR) + "/docs/state_models.md");
  std::string text, line;
  while (std::getline(file, line) && !line.starts_with("    hydroscope"))
    if (line.starts_with("    ")) text += line.substr(4) + "\n";
  return text;
}

TEST(StateMachines, ALawThatMayBeMissingIsToldByCompareAsByExplain) {
  EpisodeLog log;
  log.machine = ParseMachine(ExampleOfTheDocs(), "state_models.md").value();
  log.episodes = {EpisodeOf(SimulateStates({StateMachineKind::kTanks, "", 3, 600}), log.machine)};
  auto fit = FitEpisodes(std::move(log));
  ASSERT_TRUE(fit) << fit.error().text;
  fit->left.structured = false;
  fit->left.doubtful = true;
  const auto told = [&](double one_step) {
    fit->error.one_step = one_step * fit->error.rms;
    return CompareText(*fit);
  };
  EXPECT_THAT(told(0.7), testing::HasSubstr("Something may be missing"));
  EXPECT_THAT(told(0.7), testing::HasSubstr("WARNING"));
  EXPECT_THAT(told(0.99), testing::HasSubstr("noise alone is left"));
}

/// Inputs are held. Straight lines are what a file that says nothing means; a spline it says itself.
TEST(StateMachines, HowInputsMoveIsFoundWhereTheFileDoesNotSayIt) {
  Machine machine = StatesMachine(StateMachineKind::kOscillator, "");
  EpisodeLog log;
  log.episodes = {EpisodeOf(SimulateStates({StateMachineKind::kOscillator, "cubic", 6, 1000}), machine)};
  const auto told_once = [](const std::vector<Told>& warnings) {
    return std::ranges::count_if(warnings, [](const Told& warning) {
             return warning.english.find("hold = \"zero\"") != std::string::npos;
           }) == 1;
  };
  for (const InputHold hold : {InputHold::kLinear, InputHold::kSmooth}) {
    const bool found = hold == InputHold::kLinear;
    machine.log.hold = hold;
    machine.added_effects.clear();
    log.machine = machine;
    const auto explained = ExplainReadEpisodes(log);
    ASSERT_TRUE(explained) << explained.error().text;
    EXPECT_EQ(explained->explanation.verdict, found ? Verdict::kNamed : Verdict::kUnknown);
    EXPECT_EQ(explained->log.machine.log.hold, found ? InputHold::kZero : hold);
    EXPECT_TRUE(told_once(explained->log.warnings));
    log.machine.added_effects = {"cubic"};
    const auto fit = FitEpisodes(log);
    ASSERT_TRUE(fit) << fit.error().text;
    EXPECT_EQ(fit->log.machine.log.hold, found ? InputHold::kZero : hold);
    EXPECT_TRUE(told_once(FitWarnings(*fit)));
    EXPECT_EQ(fit->left.structured, !found);
  }
}

/// Readings of the output between its rows, as a logger takes them that reads the channels in turn.
TEST(StateMachines, OutputsThatAreNewerThanInputsAreNoLawThatIsMissing) {
  EpisodeLog log;
  log.machine = StatesMachine(StateMachineKind::kOscillator, "");
  SimulatedStates simulated{StateMachineKind::kOscillator, "", 6, 1000};
  simulated.newer = 0.25;
  log.episodes = {EpisodeOf(SimulateStates(simulated), log.machine)};
  const double period = log.episodes.front().time[1] - log.episodes.front().time[0];
  const auto explained = ExplainReadEpisodes(log);
  ASSERT_TRUE(explained) << explained.error().text;
  EXPECT_EQ(explained->explanation.verdict, Verdict::kAdequate);
  ASSERT_TRUE(explained->log.machine.log.outputs_late);
  EXPECT_NEAR(*explained->log.machine.log.outputs_late, -0.25 * period, 0.01 * period);
  EXPECT_THAT(ExplainText(*explained), testing::HasSubstr("0.25 rows newer than its inputs"));
  const auto fit = FitEpisodes(log);
  ASSERT_TRUE(fit) << fit.error().text;
  EXPECT_FALSE(fit->left.structured);
  log.machine.log.outputs_late = 0;
  const auto stated = ExplainReadEpisodes(log);
  ASSERT_TRUE(stated) << stated.error().text;
  EXPECT_EQ(stated->explanation.verdict, Verdict::kUnknown);
}

/// A sensor's zero that the file lacks covers what else is missing: it is taken, alone it is no all-clear.
TEST(StateMachines, TheZeroOfASensorThatTheFileLacksHidesNoFriction) {
  EpisodeLog log;
  log.machine = StatesMachine(StateMachineKind::kOscillator, "");
  StatesSpec& states = log.machine.states;
  states.outputs.front().expression = "gain*x";
  std::erase_if(states.parameters, [](const ParameterSpec& parameter) { return parameter.name == "zero"; });
  std::erase_if(log.machine.user_effects,
                [](const UserEffectSpec& effect) { return effect.id != "coulomb"; });
  for (const std::string hidden : {"coulomb", ""}) {
    log.episodes = {EpisodeOf(SimulateStates({StateMachineKind::kOscillator, hidden, 6, 600}), log.machine)};
    auto readings = log.episodes.front().signal.col(1);
    readings.array() += 0.3 * readings.norm() / std::sqrt(static_cast<double>(readings.size()));
    const auto explained = ExplainReadEpisodes(log);
    ASSERT_TRUE(explained) << explained.error().text;
    const StatesExplanation& x = explained->explanation;
    EXPECT_EQ(x.verdict, hidden.empty() ? Verdict::kUnknown : Verdict::kNamed);
    EXPECT_EQ(x.set, hidden.empty() ? std::vector<std::string>{} : std::vector{hidden});
    const std::string text = ExplainText(*explained);
    EXPECT_THAT(text, testing::HasSubstr("the zero of a sensor"));
    const std::string signal = log.machine.states.outputs.front().signal;
    for (const std::string& said : {std::string("But for a constant"), "Read " + signal + " where"})
      EXPECT_EQ(text.find(said) != std::string::npos, hidden.empty()) << said;
  }
  const auto fit = FitEpisodes(log);
  ASSERT_TRUE(fit) << fit.error().text;
  EXPECT_FALSE(fit->left.structured);
  EXPECT_THAT(CompareText(*fit), testing::HasSubstr("But for a constant"));
}

TEST(StateMachines, TheExampleOfTheDocsIsFitted) {
  const auto machine = ParseMachine(ExampleOfTheDocs(), "state_models.md");
  ASSERT_TRUE(machine) << machine.error().text;
  const Episode episode = EpisodeOf(SimulateStates({StateMachineKind::kTanks, "", 3, 600}), *machine);
  const auto model = BuildStateModel(*machine, {});
  ASSERT_TRUE(model) << model.error().text;
  const StateFit fit = FitStates(*model, std::span(&episode, 1));
  ASSERT_TRUE(fit.solved()) << fit.failed.english;
  EXPECT_LT(fit.noise[0], 0.01 * fit.scale[0]);
  EXPECT_TRUE(BuildStateModel(*machine, {"overflow", "leak"}));
}

}  // namespace
}  // namespace hydroscope
