#include "estimation/states/simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "estimation/states/fit.h"
#include "estimation/states/unseen_ripple.h"

namespace hydroscope {
namespace {

Machine StatesFrom(const std::string& text) {
  const auto machine = ParseMachine(text, "states.toml");
  EXPECT_TRUE(machine) << (machine ? "" : machine.error().text);
  return machine.value_or(Machine{});
}

const std::string kSignals = R"toml([signals]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "V" }
)toml";

/// x' = -k x + u, held inputs.
Machine Lag(const std::string& state = "initial = \"y\"") {
  return StatesFrom("[log]\nhold = \"zero\"\n" + kSignals + "[states]\nx = { ddt = \"-k*x + u\", " + state +
                    " }\n[outputs]\ny = \"x\"\n[parameters]\nk = { start = 2, min = 0.1, max = 1e7 }\n");
}

Episode Rows(int rows, double period, double input) {
  Episode episode;
  episode.signal = RowMatrix::Zero(rows, 2);
  for (int row = 0; row < rows; ++row) {
    episode.time.push_back(row * period);
    episode.signal(row, 0) = input;
  }
  return episode;
}

StateRun RunOf(const Machine& machine, const Episode& episode, const Eigen::VectorXd& parameters, double x0,
               const RowMatrix* slopes = nullptr) {
  const auto model = BuildStateModel(machine, {});
  EXPECT_TRUE(model) << (model ? "" : model.error().text);
  StateSimulator simulator(*model);
  simulator.SetParameters(parameters);
  StateRun run;
  simulator.Run(episode, 0, episode.rows() - 1, Eigen::VectorXd::Constant(1, x0), slopes, run);
  return run;
}

TEST(StateModel, EstimatesAnInitialValueThatIsReadOffAnOutput) {
  const auto estimated = [](const std::string& initial) {
    return BuildStateModel(Lag("initial = " + initial), {}).value()->estimated.front();
  };
  EXPECT_TRUE(estimated("\"y\"")) << "the reading is noisy, and the model would carry its noise on";
  EXPECT_TRUE(estimated("\"2*y - u\""));
  EXPECT_FALSE(estimated("\"u\""));
  EXPECT_FALSE(estimated("0"));
}

TEST(StateSimulation, FollowsAnExponentialAndItsDerivatives) {
  const Episode episode = Rows(50, 0.05, 3);
  RowMatrix slopes(1, 2);
  slopes << 0, 1;  // parameter, initial state
  const double k = 2;
  const StateRun run = RunOf(Lag(), episode, Eigen::VectorXd::Constant(1, k), 1, &slopes);
  ASSERT_FALSE(run.diverged);
  for (int row = 0; row < 50; row += 7) {
    const double t = 0.05 * row, e = std::exp(-k * t);
    EXPECT_NEAR(run.outputs(row, 0), e + 3 / k * (1 - e), 1e-5);
    EXPECT_NEAR(run.slopes(row, 1), e, 1e-5);
    EXPECT_NEAR(run.slopes(row, 0), -t * e - 3 / (k * k) * (1 - e) + 3 / k * t * e, 2e-5);
  }
}

TEST(StateSimulation, AReadingThatIsAMeanIsThatOfTheModelAndItsDerivatives) {
  Episode episode = Rows(41, 0.05, 0);
  episode.mean_rows = 8;
  RowMatrix slopes(1, 2);
  slopes << 0, 1;
  const double k = 2;
  const StateRun run = RunOf(Lag(), episode, Eigen::VectorXd::Constant(1, k), 1, &slopes);
  EXPECT_TRUE(std::isnan(run.outputs(0, 0))) << "nothing is known before the first row";
  EXPECT_NEAR(run.outputs(3, 0), std::exp(-k * 0.15), 1e-5) << "no reading: the model as it is";
  for (int row = 8; row <= 40; row += 8) {
    const double from = 0.05 * (row - 8), to = 0.05 * row;
    const double mean = (std::exp(-k * from) - std::exp(-k * to)) / (k * (to - from));
    EXPECT_NEAR(run.outputs(row, 0), mean, 2e-5) << row;
    EXPECT_NEAR(run.slopes(row, 1), mean, 2e-5) << "by the initial state";
  }
}

TEST(StateSimulation, ARippleOfAnOutputDrivesAStateAlongLinesBetweenRows) {
  const Machine machine = StatesFrom(
      "[signals]\nn = { column = \"n\", unit = \"rad/s\" }\ny = { column = \"y\", unit = \"V\" }\n"
      "[episodes]\nshaft = \"n\"\n[states]\nx = { ddt = \"k*y_ripple\", initial = 0, unit = \"V\" }\n"
      "[outputs]\ny = \"x\"\n[parameters]\nk = { start = 2, min = 0.1, max = 10, unit = \"1/s\" }\n");
  Episode episode = Rows(4, 0.5, 3);
  RowMatrix slopes = RowMatrix::Zero(1, 1);
  const Eigen::VectorXd k = Eigen::VectorXd::Constant(1, 2);
  EXPECT_EQ(RunOf(machine, episode, k, 0, &slopes).outputs(3, 0), 0) << "none is known";
  episode.ripple = RowMatrix::Zero(4, 2);
  episode.ripple.col(1) << 0, 1, 1, 0;
  const StateRun run = RunOf(machine, episode, k, 0, &slopes);
  for (const auto& [row, integral] : {std::pair(1, 0.25), std::pair(2, 0.75), std::pair(3, 1.0)}) {
    EXPECT_NEAR(run.outputs(row, 0), 2 * integral, 1e-6);
    EXPECT_NEAR(run.slopes(row, 0), integral, 1e-6);
  }
  const Episode part = episode.Part(1, 3);
  EXPECT_EQ(part.rows(), 3);
  EXPECT_EQ(part.ripple(1, 1), 1);
}

TEST(StateSimulation, WhatActsNearZeroAloneActsByMoreThanRipple) {
  const Machine machine = StatesFrom(
      "[signals]\nn = { column = \"n\", unit = \"rad/s\" }\ny = { column = \"y\", unit = \"V\" }\n"
      "[episodes]\nshaft = \"n\"\n[states]\nx = { ddt = \"k*y_ripple - r*exp(-abs(x)/1e-5)\", initial = 0, unit = \"V\" }\n"
      "[outputs]\ny = \"x\"\n[parameters]\nk = { start = 2, min = 0.1, max = 10, unit = \"1/s\" }\n"
      "r = { start = 1, min = 0, max = 2, unit = \"V/s\" }\n");
  const auto model = BuildStateModel(machine, {});
  ASSERT_TRUE(model) << model.error().text;
  EXPECT_TRUE(OnlyRippleShows(**model, {{{"k", 1.0}}}));
  EXPECT_FALSE(OnlyRippleShows(**model, {{{"r", 1.0}}}));
  EXPECT_FALSE(OnlyRippleShows(**model, {{{"k", 1.0}, {"r", 1.0}}}));
}

TEST(StateSimulation, AStiffModelIsLeftToTheImplicitMethodWithTheSameDerivatives) {
  const Episode episode = Rows(20, 0.05, 3);
  RowMatrix slopes(1, 2);
  slopes << 0, 1;
  const double k = 1e5;
  const StateRun run = RunOf(Lag(), episode, Eigen::VectorXd::Constant(1, k), 1, &slopes);
  ASSERT_FALSE(run.diverged);
  EXPECT_NEAR(run.outputs(19, 0), 3 / k, 1e-8);
  EXPECT_NEAR(run.slopes(19, 0), -3 / (k * k), 1e-13);
  EXPECT_NEAR(run.slopes(19, 1), 0, 1e-8);
}

TEST(StateSimulation, SensitivitiesStayBoundedWhereAStiffStateRests) {
  const Episode episode = Rows(40, 1, 3);
  RowMatrix slopes(1, 2);
  slopes << 0, 1;
  const double k = 12;  // at rest, so that no step looks too long by its error
  const StateRun run = RunOf(Lag(), episode, Eigen::VectorXd::Constant(1, k), 3 / k, &slopes);
  EXPECT_NEAR(run.slopes(39, 0), -3 / (k * k), 1e-8);
  EXPECT_NEAR(run.slopes(39, 1), 0, 1e-8);
}

TEST(StateSimulation, StopsAtALimitAndComesBack) {
  Episode episode = Rows(60, 0.1, 5);
  for (int row = 30; row < 60; ++row) episode.signal(row, 0) = 0;
  const StateRun run = RunOf(Lag("max = 1.5"), episode, Eigen::VectorXd::Constant(1, 2.0), 0);
  EXPECT_EQ(run.outputs(25, 0), 1.5);
  EXPECT_NEAR(run.outputs(35, 0), 1.5 * std::exp(-1.0), 1e-4);
}

/// x' = -k x + u of `seconds` ago.
Machine DelayedLag(const std::string& hold) {
  return StatesFrom("[log]\nhold = \"" + hold + "\"\n" + kSignals +
                    "[states]\nx = { ddt = \"-2*x + delay(u, dead)\", initial = 0 }\n[outputs]\ny = \"x\"\n"
                    "[parameters]\ndead = { start = 0.1, min = 0, max = 1 }\n");
}

TEST(StateSimulation, AnEmptyTankFillsWhenItsPumpBeginsToTurn) {
  const Machine machine =
      StatesFrom("[log]\nhold = \"linear\"\n" + kSignals +
                 "[states]\nh = { ddt = \"0.05*u - k*sqrt(max(h, 0))\", min = 0 }\n[outputs]\ny = "
                 "\"h\"\n[parameters]\nk = { start = 0.05, min = 0.005, max = 1 }\n");
  Episode episode = Rows(200, 4, 0);
  for (int row = 0; row < 200; ++row) episode.signal(row, 0) = 0.01 * std::min(row, 100);
  RowMatrix slopes = RowMatrix::Zero(1, 2);
  slopes(0, 1) = 1;
  const StateRun run = RunOf(machine, episode, Eigen::VectorXd::Constant(1, 0.05), 0, &slopes);
  ASSERT_FALSE(run.diverged) << "after " << run.rows << " rows";
  EXPECT_NEAR(run.outputs(199, 0), 1, 0.02);  // (0.05 * 1 / 0.05)^2
}

TEST(StateSimulation, ADelayedStepArrivesBetweenTwoRowsWithItsExactDerivative) {
  Episode episode = Rows(60, 0.05, 0);
  for (int row = 10; row < 60; ++row) episode.signal(row, 0) = 1;
  const double dead = 0.123;
  RowMatrix slopes(1, 1);
  slopes << 0;
  const StateRun run = RunOf(DelayedLag("zero"), episode, Eigen::VectorXd::Constant(1, dead), 0, &slopes);
  ASSERT_FALSE(run.diverged);
  for (int row = 0; row < 60; row += 3) {
    const double since = 0.05 * row - 0.5 - dead, e = since > 0 ? std::exp(-2 * since) : 1;
    EXPECT_NEAR(run.outputs(row, 0), (1 - e) / 2, 1e-6);
    EXPECT_NEAR(run.slopes(row, 0), since > 0 ? -e : 0, 1e-5);
  }
}

TEST(StateSimulation, ADelayOfAnInputThatMovesEvenlyHasTheDerivativeOfDifferences) {
  Episode episode = Rows(80, 0.05, 0);
  for (int row = 0; row < 80; ++row) episode.signal(row, 0) = std::sin(0.01 * row * row);
  RowMatrix slopes(1, 1);
  slopes << 0;
  const double dead = 0.177, by = 1e-3;
  const auto at = [&](double seconds) {
    return RunOf(DelayedLag("linear"), episode, Eigen::VectorXd::Constant(1, seconds), 0, &slopes);
  };
  const StateRun run = at(dead), more = at(dead + by), less = at(dead - by);
  for (int row = 5; row < 80; row += 5)
    EXPECT_NEAR(run.slopes(row, 0), (more.outputs(row, 0) - less.outputs(row, 0)) / (2 * by), 2e-3);
}

TEST(StateSimulation, SensitivitiesByInitialStatesAreTheSameWhereParametersAreKnown) {
  const Episode episode = Rows(50, 0.05, 3);
  RowMatrix all(1, 2), initial(1, 1);
  all << 0, 1;
  initial << 1;
  const auto model = BuildStateModel(Lag("max = 1.2"), {}).value();
  const Eigen::VectorXd k = Eigen::VectorXd::Constant(1, 2), x0 = Eigen::VectorXd::Constant(1, 1);
  StateSimulator free(model), known(model);
  known.KnowParameters();
  StateRun with, without;
  free.SetParameters(k);
  free.Run(episode, 0, 49, x0, &all, with);
  known.SetParameters(k);
  known.Run(episode, 0, 49, x0, &initial, without);
  EXPECT_EQ(without.outputs, with.outputs);
  EXPECT_EQ(without.slopes.col(0), with.slopes.col(1));
}

TEST(StateSimulation, OutputsThatAreOlderThanInputsSeeThoseOfTheirTime) {
  constexpr int kRows = 80, kStep = 30;
  constexpr double kPeriod = 0.05;
  Episode episode = Rows(kRows, kPeriod, 0);
  for (int row = kStep; row < kRows; ++row) episode.signal(row, 0) = 1;
  for (const double late : {0.123, -0.018, -0.07}) {
    for (const double dead : {0.0, 0.04}) {
      Machine machine = DelayedLag("zero");
      machine.log.outputs_late = late;
      const StateRun run = RunOf(machine, episode, Eigen::VectorXd::Constant(1, dead), 0);
      ASSERT_FALSE(run.diverged);
      for (int row = 0; row < kRows; ++row) {
        const double since = kPeriod * (row - kStep) - dead - late;
        EXPECT_NEAR(run.outputs(row, 0), since > 0 ? (1 - std::exp(-2 * since)) / 2 : 0, 1e-6)
            << late << " " << row;
      }
    }
    Machine direct = Lag("initial = 0");
    direct.log.outputs_late = late;
    const StateRun run = RunOf(direct, episode, Eigen::VectorXd::Constant(1, 2), 0);
    for (int row = 0; row < kRows; ++row) {
      const double since = kPeriod * (row - kStep) - late;
      EXPECT_NEAR(run.outputs(row, 0), since > 0 ? (1 - std::exp(-2 * since)) / 2 : 0, 1e-6)
          << late << " " << row;
    }
  }
}

TEST(StateSimulation, AnInputThatMovesSmoothlyIsFollowedBetweenItsRows) {
  constexpr double kOmega = 2 * std::numbers::pi * 0.2 / 0.05;  // a fifth of the sampling rate
  Episode episode = Rows(200, 0.05, 0);
  for (int row = 0; row < 200; ++row)
    episode.signal(row, 0) = std::sin(kOmega * episode.time[static_cast<std::size_t>(row)]);
  const auto worst = [&](const std::string& hold, double dead) {
    const StateRun run = RunOf(DelayedLag(hold), episode, Eigen::VectorXd::Constant(1, dead), 0);
    double error = 0;
    for (int row = 150; row < 190; ++row) {  // x' = -2 x + sin(w (t - dead)), long after its beginning
      const double t = kOmega * (episode.time[static_cast<std::size_t>(row)] - dead);
      const double x = (2 * std::sin(t) - kOmega * std::cos(t)) / (4 + kOmega * kOmega);
      error = std::max(error, std::abs(run.outputs(row, 0) - x) * kOmega);
    }
    return error;
  };
  for (const double dead : {0.0, 0.123}) {
    EXPECT_LT(worst("smooth", dead), 0.01) << dead;
    EXPECT_GT(worst("linear", dead), 0.1) << dead;
  }
}

TEST(StateSimulation, ADelayOfAnInputThatMovesSmoothlyHasTheDerivativeOfDifferences) {
  Episode episode = Rows(80, 0.05, 0);
  for (int row = 0; row < 80; ++row) episode.signal(row, 0) = std::sin(0.01 * row * row);
  RowMatrix slopes(1, 1);
  slopes << 0;
  const double dead = 0.177, by = 1e-3;
  const auto at = [&](double seconds) {
    return RunOf(DelayedLag("smooth"), episode, Eigen::VectorXd::Constant(1, seconds), 0, &slopes);
  };
  const StateRun run = at(dead), more = at(dead + by), less = at(dead - by);
  for (int row = 5; row < 80; row += 5)
    EXPECT_NEAR(run.slopes(row, 0), (more.outputs(row, 0) - less.outputs(row, 0)) / (2 * by), 2e-3);
}

TEST(StateSimulation, AModelThatRunsAwayIsSaidToDiverge) {
  const Machine machine = StatesFrom(kSignals +
                                     "[states]\nx = { ddt = \"a*x^2 + u\" }\n[outputs]\ny = \"x\"\n"
                                     "[parameters]\na = { start = 5, min = 1, max = 10 }\n");
  EXPECT_TRUE(RunOf(machine, Rows(100, 0.1, 1), Eigen::VectorXd::Constant(1, 5.0), 1).diverged);
  const Episode episode = Rows(100, 0.1, 1);
  const auto model = BuildStateModel(machine, {});
  ASSERT_TRUE(model);
  const StateFit fit = FitStates(*model, std::span(&episode, 1));
  EXPECT_FALSE(fit.solved());
  EXPECT_NE(fit.failed.english.find("diverges"), std::string::npos) << fit.failed.english;
}

/// A fit tries such parameters, and would stay with them for minutes.
TEST(StateSimulation, ASwingOfManyPeriodsBetweenTwoRowsIsGivenUp) {
  const Machine swing = StatesFrom(
      kSignals +
      "[states]\nx = { ddt = \"v\", initial = \"y\" }\nv = { ddt = \"-w^2*x\", initial = \"estimate\" }\n"
      "[outputs]\ny = \"x\"\n[parameters]\nw = { start = 1, min = 0.1, max = 1e6 }\n");
  const auto model = BuildStateModel(swing, {});
  ASSERT_TRUE(model) << model.error().text;
  StateSimulator simulator(*model);
  simulator.SetParameters(Eigen::VectorXd::Constant(1, 1000.0));
  StateRun run;
  simulator.Run(Rows(1000, 1, 0), 0, 999, Eigen::Vector2d(1, 0), nullptr, run);
  EXPECT_TRUE(run.diverged);
  EXPECT_LT(simulator.steps(), 20'000);
}

TEST(StateFit, SaysThatRatesAreNotFiniteWhereAModelBegins) {
  const Machine machine =
      StatesFrom(kSignals +
                 "[states]\nx = { ddt = \"u - a*sqrt(x - 5)\", initial = 0 }\n[outputs]\ny = \"x\"\n"
                 "[parameters]\na = { start = 5, min = 1, max = 10 }\n");
  const Episode episode = Rows(100, 0.1, 1);
  const auto model = BuildStateModel(machine, {});
  ASSERT_TRUE(model);
  const StateFit fit = FitStates(*model, std::span(&episode, 1));
  EXPECT_NE(fit.failed.english.find("not finite at the first row"), std::string::npos) << fit.failed.english;
}

TEST(StateFit, SaysWhichCombinationTheDataDoNotSee) {
  const Machine machine = StatesFrom("[log]\nhold = \"zero\"\n" + kSignals +
                                     "[states]\nx = { ddt = \"(b*u - x)/(b*c)\", initial = \"estimate\" }\n"
                                     "[outputs]\ny = \"x/b\"\n[parameters]\nb = { start = 2, min = 0.1, max "
                                     "= 10 }\nc = { start = 1, min = 0.1, max = 10 }\n");
  // y' = (u - y)/(b c): only the product of b and c is seen.
  Episode episode = Rows(300, 0.05, 0);
  double y = 0;
  for (int row = 0; row < 300; ++row) {
    const double u = row / 40 % 2;
    episode.signal(row, 0) = u;
    episode.signal(row, 1) = y + 1e-3 * std::sin(17.0 * row * row);
    y = u + (y - u) * std::exp(-0.05 / 1.2);
  }
  const auto model = BuildStateModel(machine, {});
  ASSERT_TRUE(model) << model.error().text;
  const StateFit fit = FitStates(*model, std::span(&episode, 1));
  ASSERT_TRUE(fit.solved()) << fit.failed.english;
  EXPECT_NEAR(fit.parameters[0] * fit.parameters[1], 1.2, 0.01);
  ASSERT_EQ(fit.unseen.size(), 1u);
  ASSERT_EQ(fit.unseen[0].parts.size(), 2u);
  EXPECT_LT(fit.unseen[0].parts[0].second * fit.unseen[0].parts[1].second, 0) << "one up, the other down";
}

TEST(StateFit, FindsADeadTimeThatIsNoMultipleOfTheRows) {
  const double dead = 0.213, period = 0.05;
  Episode episode = Rows(400, period, 0);
  double y = 0;
  const auto input = [&](double t) {
    return t < 0 ? 0.0 : static_cast<double>(static_cast<int>(t / 1.1) % 2);
  };
  for (int row = 0; row < 400; ++row) {
    // Steps fall on rows: a converter holds them.
    const auto held = [&](double t) { return input(period * std::floor(t / period + 1e-9)); };
    episode.signal(row, 0) = held(row * period);
    episode.signal(row, 1) = y + 1e-3 * std::sin(17.0 * row * row);
    const double jump = (row + 1) * period - std::fmod((row + 1) * period - dead + 10 * period, period);
    for (const auto& [from, to] : {std::pair(row * period, jump), std::pair(jump, (row + 1) * period)}) {
      const double u = held(0.5 * (from + to) - dead);
      y = u / 2 + (y - u / 2) * std::exp(-2 * (to - from));
    }
  }
  const auto model = BuildStateModel(DelayedLag("zero"), {});
  ASSERT_TRUE(model) << model.error().text;
  const StateFit fit = FitStates(*model, std::span(&episode, 1));
  ASSERT_TRUE(fit.solved()) << fit.failed.english;
  EXPECT_NEAR(fit.parameters[0], dead, 2e-3);
}

TEST(StateFit, PredictionFindsParametersWhereNoiseActsOnTheProcess) {
  // x' = -0.7 x + u with a disturbance held from row to row, large against the noise of the sensor.
  constexpr double kTrue = 0.7, kPeriod = 0.05;
  const double decay = std::exp(-kTrue * kPeriod), rise = (1 - decay) / kTrue;
  const auto model = BuildStateModel(Lag("initial = \"estimate\""), {});
  ASSERT_TRUE(model);
  double free_spread = 0, spread = 0;
  constexpr int kLogs = 20;
  int inside = 0;
  for (int log = 0; log < kLogs; ++log) {
    std::mt19937 random(static_cast<unsigned>(log + 1));
    std::normal_distribution<double> normal;
    Episode episode = Rows(600, kPeriod, 0);
    double x = 0;
    for (int row = 0; row < 600; ++row) {
      const double u = row / 40 % 2;
      episode.signal(row, 0) = u;
      episode.signal(row, 1) = x + 2e-3 * normal(random);
      x = decay * x + rise * (u + 0.8 * normal(random));
    }
    StateFitOptions options;
    options.starts = 0;
    const StateFit free_run = FitStates(*model, std::span(&episode, 1), options);
    ASSERT_TRUE(free_run.solved()) << free_run.failed.english;
    const StateFit fit = PredictStates(free_run, std::span(&episode, 1), options);
    ASSERT_TRUE(fit.solved()) << fit.failed.english;
    EXPECT_LT(fit.noise[0], 0.5 * free_run.noise[0]);
    EXPECT_NEAR(fit.gain(0, 0), 1, 0.1) << "the sensor is much better than the process";
    inside += std::abs(fit.parameters[0] - kTrue) < 2 * std::sqrt(fit.covariance(0, 0));
    spread += std::pow(fit.parameters[0] - kTrue, 2);
    free_spread += std::pow(free_run.parameters[0] - kTrue, 2);
  }
  EXPECT_GE(inside, 16) << "of " << kLogs << " intervals of 95 %";
  EXPECT_LT(std::sqrt(spread / kLogs), 0.06);
  EXPECT_LT(spread, free_spread);
}

TEST(StateFit, IntervalsHoldTheTruthWhereFewPiecesOfTheLogTellOfAParameter) {
  // One pulse in 600 rows, errors correlated over some four rows.
  constexpr double kTrue = 0.7, kPeriod = 0.05, kCorrelated = 0.6;
  constexpr int kLogs = 200;
  const double decay = std::exp(-kTrue * kPeriod), rise = (1 - decay) / kTrue;
  const auto model = BuildStateModel(Lag("initial = \"0\""), {});
  ASSERT_TRUE(model) << model.error().text;
  StateFitOptions options;
  options.starts = 0;
  int inside = 0;
  for (int log = 0; log < kLogs; ++log) {
    std::mt19937 random(static_cast<unsigned>(log + 1));
    std::normal_distribution<double> normal;
    Episode episode = Rows(600, kPeriod, 0);
    double x = 0, error = 0;
    for (int row = 0; row < 600; ++row) {
      const double u = row < 10 ? 1 : 0;
      error = kCorrelated * error + 1e-3 * normal(random);
      episode.signal(row, 0) = u;
      episode.signal(row, 1) = x + error;
      x = decay * x + rise * u;
    }
    const StateFit fit = FitStates(*model, std::span(&episode, 1), options);
    ASSERT_TRUE(fit.solved()) << fit.failed.english;
    inside += std::abs(fit.parameters[0] - kTrue) < 1.96 * std::sqrt(fit.covariance(0, 0));
  }
  EXPECT_GE(inside, 0.88 * kLogs);
}

TEST(StateFit, FindsParametersFromAStartFarOff) {
  Episode episode = Rows(300, 0.05, 0);
  double y = 0.4;
  for (int row = 0; row < 300; ++row) {
    const double u = row / 40 % 2;
    episode.signal(row, 0) = u;
    episode.signal(row, 1) = y + 1e-3 * std::sin(17.0 * row * row);
    y = u / 0.7 + (y - u / 0.7) * std::exp(-0.05 * 0.7);
  }
  const auto model = BuildStateModel(Lag("initial = \"estimate\""), {});
  ASSERT_TRUE(model);
  const StateFit fit = FitStates(*model, std::span(&episode, 1));
  ASSERT_TRUE(fit.solved()) << fit.failed.english;
  const double std = std::sqrt(fit.covariance(0, 0));
  EXPECT_NEAR(fit.parameters[0], 0.7, 3 * std + 1e-4);
  EXPECT_LT(std, 0.01);
  EXPECT_NEAR(fit.initial[0][0], 0.4, 2e-3);
}

TEST(StateFit, WhatStandsAtALimitStaysThereInErrorsLeftOut) {
  const Machine machine =
      StatesFrom("[log]\nhold = \"zero\"\n" + kSignals +
                 "[states]\nx = { ddt = \"u - a*x\", initial = \"estimate\" }\n"
                 "[outputs]\ny = \"x\"\n[parameters]\na = { start = 2, min = 1, max = 10 }\n");
  Episode episode = Rows(300, 0.05, 0);
  double y = 0;
  for (int row = 0; row < 300; ++row) {
    const double u = row / 40 % 2;
    episode.signal(row, 0) = u;
    episode.signal(row, 1) = y;
    y = u / 0.7 + (y - u / 0.7) * std::exp(-0.05 * 0.7);
  }
  const auto model = BuildStateModel(machine, {});
  ASSERT_TRUE(model) << model.error().text;
  const StateFit fit = FitStates(*model, std::span(&episode, 1));
  ASSERT_TRUE(fit.solved()) << fit.failed.english;
  ASSERT_TRUE(fit.at_limit[0]) << "the truth, 0.7, is not in the range";
  double energy = 0;
  for (const StatePiece& piece : fit.pieces) energy += piece.energy;
  EXPECT_GE(fit.HeldOutEnergy(), 0.999 * energy) << "beyond the limit the error would be smaller";
}

}  // namespace
}  // namespace hydroscope
