#include "estimation/state_simulation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimation/state_fit.h"

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
  EXPECT_NE(fit.failed.find("diverges"), std::string::npos) << fit.failed;
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
  ASSERT_TRUE(fit.solved()) << fit.failed;
  EXPECT_NEAR(fit.parameters[0] * fit.parameters[1], 1.2, 0.01);
  ASSERT_EQ(fit.unseen.size(), 1u);
  ASSERT_EQ(fit.unseen[0].parts.size(), 2u);
  EXPECT_LT(fit.unseen[0].parts[0].second * fit.unseen[0].parts[1].second, 0) << "one up, the other down";
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
  ASSERT_TRUE(fit.solved()) << fit.failed;
  const double std = std::sqrt(fit.covariance(0, 0));
  EXPECT_NEAR(fit.parameters[0], 0.7, 3 * std + 1e-4);
  EXPECT_LT(std, 0.01);
  EXPECT_NEAR(fit.initial[0][0], 0.4, 2e-3);
}

}  // namespace
}  // namespace hydroscope
