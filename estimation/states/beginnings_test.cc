#include "estimation/states/beginnings.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimation/states/fit_task.h"
#include "models/machine.h"

namespace hydroscope {
namespace {

/// A pendulum that is left to itself; at 2.9 rad it swings slowly, and the phase of its swing is in none of its readings.
constexpr const char* kFreePendulum = R"toml([signals]
y = { column = "y", unit = "V" }
[states]
x = { ddt = "v", initial = "estimate" }
v = { ddt = "-w^2*sin(x)", initial = "estimate" }
[outputs]
y = "x"
[parameters]
w = { start = 6, min = 1, max = 20 }
)toml";

TEST(Beginnings, AreFoundWhereTheGuessIsOfTheWrongPhase) {
  const auto machine = ParseMachine(kFreePendulum, "pendulum");
  ASSERT_TRUE(machine) << machine.error().text;
  const auto model = BuildStateModel(*machine, {});
  ASSERT_TRUE(model) << model.error().text;
  Episode episode;
  constexpr int kRows = 400;
  constexpr double kPeriod = 0.02;
  episode.signal.resize(kRows, 1);
  double x = 2.9, v = 0;
  for (int row = 0; row < kRows; ++row) {
    constexpr int kSteps = 200;
    episode.time.push_back(row * kPeriod);
    episode.signal(row, 0) = x;
    for (int k = 0; k < kSteps; ++k) {  // symplectic: energy stays
      v -= kPeriod / kSteps * 36 * std::sin(x);
      x += kPeriod / kSteps * v;
    }
  }
  const shooting::Task task = shooting::TaskOf(*model, {&episode, 1});
  const auto segments = shooting::ShortSegments(task.episodes, 50);
  shooting::Point point = shooting::PointAt(task, Eigen::VectorXd::Constant(1, 6.0));
  for (std::size_t s = 0; s < segments.size(); ++s) point.z.push_back({0, 0});
  shooting::SeekBeginnings(task, segments, 50, point);
  StateSimulator simulator(*model);
  simulator.SetParameters(Eigen::VectorXd::Constant(1, 6.0));
  for (std::size_t s = 0; s < segments.size(); ++s) {
    StateRun run;
    const Eigen::VectorXd x0 = Eigen::Vector2d(point.z[s][0], point.z[s][1]).cwiseProduct(task.state_scale);
    simulator.Run(episode, segments[s].first, segments[s].last, x0, nullptr, run);
    for (int row = 0; row < run.rows; ++row)
      ASSERT_NEAR(run.outputs(row, 0), episode.signal(segments[s].first + row, 0), 0.3) << "segment " << s;
  }
}

}  // namespace
}  // namespace hydroscope
