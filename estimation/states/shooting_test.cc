#include "estimation/states/shooting.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimation/states/fit_task.h"
#include "models/machine.h"

namespace hydroscope {
namespace {

/// A step is tried without slopes, and run with them once it is taken.
TEST(Shooting, AnIterationCostsOneRunWithSlopesAndOneWithout) {
  const auto machine = ParseMachine(R"toml([signals]
u = { column = "u", unit = "rad/s2" }
y = { column = "y", unit = "rad" }
[states]
x = { ddt = "v", initial = "estimate" }
v = { ddt = "-w^2*x + u", initial = "estimate" }
[outputs]
y = "x"
[parameters]
w = { start = 2.45, min = 2, max = 3, unit = "rad/s" }
)toml",
                                    "pendulum");
  ASSERT_TRUE(machine) << machine.error().text;
  constexpr int kRows = 100;
  constexpr double kPeriod = 0.05, kRate = 2.5;  // s, rad/s
  Episode episode;
  episode.signal = RowMatrix::Zero(kRows, 2);
  for (int row = 0; row < kRows; ++row) {
    episode.time.push_back(kPeriod * row);
    episode.signal(row, 1) = std::cos(kRate * kPeriod * row);
  }
  const auto model = BuildStateModel(*machine, {}).value();
  const std::vector<shooting::Segment> whole = shooting::WholeEpisodes(std::span(&episode, 1));
  const auto spent = [&](int iterations) {
    shooting::Task task = shooting::TaskOf(model, std::span(&episode, 1));
    task.effort = std::make_shared<shooting::Effort>();
    shooting::Point point = shooting::PointAt(task, Eigen::VectorXd::Constant(1, 2.45));
    shooting::GuessSegments(task, whole, point);
    EXPECT_TRUE(
        shooting::Minimise(task, whole, {.iterations = iterations, .tolerance = 1e-12}, false, point));
    return static_cast<double>(task.effort->spent);
  };
  constexpr double kWithout = 0.25, kALittle = 0.1;  // of a run with slopes; steps differ by the point
  EXPECT_GT(spent(3), spent(2));
  EXPECT_LT(spent(3), (1 + 3 * (1 + kWithout + kALittle)) * spent(0));
}

}  // namespace
}  // namespace hydroscope
