#include "diagnosis/states/state_experiment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "diagnosis/states/record_move.h"
#include "models/machine.h"

namespace hydroscope {
namespace {

/// What leaves the store grows with the square of what is in it, or with the cube: alike as long as little moves.
constexpr const char* kStore = R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "1" }
[states]
x = { ddt = "g*u - k*x + b", initial = "estimate" }
[outputs]
y = "x"
[parameters]
g = { start = 1, min = 0.2, max = 5 }
k = { start = 1, min = 0.1, max = 5 }
b = { start = 0, min = -2, max = 2 }
[[effect]]
id = "square"
adds = { x = "-c*x^2" }
parameters = { c = { start = 0.1, min = 0, max = 5 } }
[[effect]]
id = "cube"
adds = { x = "-c*x^3" }
parameters = { c = { start = 0.1, min = 0, max = 5 } }
)toml";

constexpr const char* kMayBeDriven = "[experiment]\nsignals = { u = { min = 0, max = 3.5 } }\n";

Machine Store(const std::string& more = "") {
  const auto machine = ParseMachine(kStore + more, "store");
  EXPECT_TRUE(machine) << machine.error().text;
  return machine.value_or(Machine{});
}

/// Inputs of an episode answered by the true store (the cube, 0.3), with noise.
Episode Answered(Episode episode, std::uint32_t seed) {
  constexpr int kSteps = 20;
  constexpr double kNoise = 5e-4;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, kNoise);
  double x = 0.9;
  for (int row = 0; row < episode.rows(); ++row) {
    episode.signal(row, 1) = x + normal(random);
    if (row + 1 == episode.rows()) break;
    const double h =
        (episode.time[static_cast<std::size_t>(row) + 1] - episode.time[static_cast<std::size_t>(row)]) /
        kSteps;
    for (int s = 0; s < kSteps; ++s) {
      const auto rate = [&](double at) { return episode.signal(row, 0) - 0.7 * at - 0.3 * at * at * at; };
      x += h * rate(x + 0.5 * h * rate(x));
    }
  }
  return episode;
}

/// Steps of 3 s about 1 V.
Episode Recorded(int rows) {
  Episode episode;
  episode.signal.resize(rows, 2);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> level(0.85, 1.15);
  for (int row = 0; row < rows; ++row) {
    episode.time.push_back(0.1 * row);
    episode.signal(row, 0) = row % 30 == 0 ? level(random) : episode.signal(row - 1, 0);
  }
  return Answered(std::move(episode), 1);
}

TEST(StateExperiment, WhatIsProposedTellsTheRivalsApart) {
  const Machine machine = Store(kMayBeDriven);
  std::vector<Episode> episodes = {Recorded(600)};
  const StatesExplanation before = ExplainStates(machine, episodes);
  ASSERT_EQ(before.verdict, Verdict::kAmbiguous);
  const StateExperiment experiment = ProposeStateExperiment(before, episodes);
  ASSERT_TRUE(experiment.settles());
  const TriedRecord& best = experiment.tried.front();
  EXPECT_GT(best.separation, 10 * experiment.now.separation);
  EXPECT_GE(best.record.signal.col(0).minCoeff(), 0);
  EXPECT_LE(best.record.signal.col(0).maxCoeff(), 3.5);
  episodes.push_back(Answered(best.record, 2));
  const StatesExplanation after = ExplainStates(machine, episodes);
  EXPECT_EQ(after.verdict, Verdict::kNamed);
  EXPECT_EQ(after.set, std::vector<std::string>{"cube"});
}

TEST(StateExperiment, InputsStayWithinWhatWasRecordedWhereNothingElseIsAllowed) {
  const Machine machine = Store();
  const std::vector<Episode> episodes = {Recorded(600)};
  const StateExperiment experiment = ProposeStateExperiment(ExplainStates(machine, episodes), episodes);
  ASSERT_FALSE(experiment.tried.empty());
  for (const TriedRecord& tried : experiment.tried) {
    EXPECT_GE(tried.record.signal.col(0).minCoeff(), episodes[0].signal.col(0).minCoeff() - 1e-9);
    EXPECT_LE(tried.record.signal.col(0).maxCoeff(), episodes[0].signal.col(0).maxCoeff() + 1e-9);
  }
}

/// Two tanks whose levels are read in a unit that the file leaves open: the scale of their states is free.
constexpr const char* kTanks = R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "V" }
[states]
a = { ddt = "g*u - k*sqrt(max(a, 0)) - c*max(a - brim, 0)", initial = "estimate", min = 0 }
x = { ddt = "k*sqrt(max(a, 0)) - m*sqrt(max(x, 0)) + w*c*max(a - brim, 0)", initial = "y", min = 0 }
[outputs]
y = "s*x"
[parameters]
g = { start = 0.04, min = 0.001, max = 1 }
k = { start = 0.055, min = 0.001, max = 1 }
m = { start = 0.05, min = 0.001, max = 1 }
s = { start = 1, min = 0.2, max = 5 }
brim = { start = 10, min = 1, max = 25 }
c = { start = 10, min = 0.05, max = 10 }
w = { start = 0.4, min = 0, max = 1 }
)toml";

TEST(StateExperiment, NoRecordShowsTheScaleOfAStateThatTheFileLeavesFree) {
  const auto machine = ParseMachine(kTanks, "tanks");
  ASSERT_TRUE(machine) << machine.error().text;
  const auto model = BuildStateModel(*machine, {});
  ASSERT_TRUE(model) << model.error().text;
  constexpr int kRows = 1000;
  std::vector<Episode> episodes(1);
  Episode& recorded = episodes.front();
  recorded.signal.resize(kRows, 2);
  for (int row = 0; row < kRows; ++row) {
    const double t = 4.0 * row;
    recorded.time.push_back(t);
    recorded.signal(row, 0) =
        3.5 + 1.3 * std::sin(0.0131 * t) + std::sin(0.0297 * t + 1) + 0.9 * std::sin(0.0413 * t + 2);
  }
  Eigen::VectorXd truth((*model)->parameter_count());
  for (int p = 0; p < truth.size(); ++p)
    truth[p] = (*model)->parameters[static_cast<std::size_t>(p)].spec.start;
  StateSimulator simulator(*model);
  simulator.SetParameters(truth);
  StateRun run;
  simulator.Run(recorded, 0, kRows - 1, Eigen::Vector2d(3, 4), nullptr, run);
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 0.02);
  for (int row = 0; row < kRows; ++row) recorded.signal(row, 1) = run.outputs(row, 0) + normal(random);
  const StateExperiment experiment = ProposeStateExperiment(ExplainStates(*machine, episodes), episodes);
  ASSERT_FALSE(experiment.unseen.empty());
  ASSERT_FALSE(experiment.tried.empty());
  EXPECT_FALSE(experiment.proposed())
      << experiment.tried.front().standard_error << " of " << experiment.now.standard_error;
}

TEST(StateExperiment, InputsThatMoveSmoothlyDoSoWhenTheyRunSlower) {
  const Machine machine = [] {
    std::string text = kStore;
    text.replace(text.find("zero"), 4, "smooth");
    return ParseMachine(text, "store").value();
  }();
  const auto model = BuildStateModel(machine, {});
  ASSERT_TRUE(model) << model.error().text;
  Episode recorded;
  constexpr int kRows = 40;
  constexpr double kPerRow = 1.2;  // rad: five rows a period
  recorded.signal = RowMatrix::Zero(kRows, 2);
  for (int row = 0; row < kRows; ++row) {
    recorded.time.push_back(row);
    recorded.signal(row, 0) = std::sin(kPerRow * row);
  }
  RecordMove slower;
  slower.speed = 0.5;
  const Episode moved = MovedRecord(slower, **model, recorded, kRows);
  for (int row = 21; row < 39; row += 2)  // between two rows; straight lines err by 0.17
    EXPECT_NEAR(moved.signal(row, 0), std::sin(0.5 * kPerRow * row), 0.03) << row;
}

}  // namespace
}  // namespace hydroscope
