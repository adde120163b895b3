#include <gtest/gtest.h>

#include <cmath>

#include "estimation/states/simulation.h"

namespace hydroscope {
namespace {

/// A mass in a dashpot with a stop: x' = v, v' = k (u - v), x <= 1.
constexpr char kMassWithStop[] = R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "V" }
[states]
x = { ddt = "v", max = 1 }
v = { ddt = "k*(u - v)", initial = 0 }
[outputs]
y = "x"
[parameters]
k = { start = 1, min = 0.1, max = 10 }
)toml";

TEST(StateSimulation, WhatIsPressedAgainstAStopComesOffAtRest) {
  const auto machine = ParseMachine(kMassWithStop, "mass.toml");
  ASSERT_TRUE(machine) << machine.error().text;
  const auto model = BuildStateModel(*machine, {});
  ASSERT_TRUE(model) << model.error().text;
  constexpr int kTurn = 60, kRows = 80;  // rows of a tenth of a second; the force turns
  Episode episode;
  episode.signal = RowMatrix::Zero(kRows, 2);
  for (int row = 0; row < kRows; ++row) {
    episode.time.push_back(0.1 * row);
    episode.signal(row, 0) = row < kTurn ? 1 : -1;
  }
  StateSimulator simulator(*model);
  simulator.SetParameters(Eigen::VectorXd::Ones(1));
  StateRun run;
  simulator.Run(episode, 0, kRows - 1, Eigen::Vector2d(0, 0), nullptr, run);
  EXPECT_EQ(run.states(kTurn, 0), 1);
  EXPECT_EQ(run.states(kTurn, 1), 0) << "what rests has no speed";
  EXPECT_NEAR(run.states(kTurn + 10, 0), 1 - std::exp(-1.0), 1e-4) << "1 - (t - (1 - exp(-t))) after 1 s";
}

}  // namespace
}  // namespace hydroscope
