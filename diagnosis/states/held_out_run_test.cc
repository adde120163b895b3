#include "diagnosis/states/held_out_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "models/machine.h"

namespace hydroscope {
namespace {

constexpr const char* kSlowStore = R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "1" }
[states]
x = { ddt = "g*u - k*x", initial = "estimate" }
[outputs]
y = "x"
[parameters]
g = { start = 1, min = 0.2, max = 5 }
k = { start = 0.1, min = 0.01, max = 5 }
)toml";

/// A store that empties within 200 rows, driven by steps; `disturbed`: amplitude of an unmeasured inflow that swings
/// over 400 rows.
Episode MeasuredStore(int rows, double noise, double disturbed, std::uint32_t seed) {
  constexpr double kPeriod = 0.1;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, noise);
  std::uniform_real_distribution<double> level(0, 1);
  Episode episode;
  episode.signal.resize(rows, 2);
  double x = 10;
  for (int row = 0; row < rows; ++row) {
    episode.time.push_back(kPeriod * row);
    episode.signal(row, 0) = row % 60 == 0 ? level(random) : episode.signal(row - 1, 0);
    episode.signal(row, 1) = x + normal(random);
    constexpr double kRate = 0.05;
    const double flow = episode.signal(row, 0) + disturbed * std::sin(2 * M_PI * row / 400);
    x = flow / kRate + (x - flow / kRate) * std::exp(-kRate * kPeriod);
  }
  return episode;
}

TEST(HeldOutRun, ADisturbanceThatAddsUpIsNotAMachineThatMagnifiesDifferences) {
  const auto machine = ParseMachine(kSlowStore, "store");
  ASSERT_TRUE(machine) << machine.error().text;
  const auto model = BuildStateModel(*machine, {});
  ASSERT_TRUE(model) << model.error().text;
  constexpr double kNoise = 0.01;
  const Episode fitted = MeasuredStore(2000, kNoise, 0, 1),
                next = MeasuredStore(2000, kNoise, 0.4 * kNoise, 2);
  const StateFit fit = FitStates(*model, std::span(&fitted, 1));
  ASSERT_TRUE(fit.solved()) << fit.failed.english;
  const StateFit followed = FollowStates(*model, std::span(&next, 1), fit.parameters, fit.noise);
  ASSERT_TRUE(followed.solved()) << followed.failed.english;
  const HeldOutRun run = LookAtHeldOut(fit, std::span(&fitted, 1), followed, std::span(&next, 1));
  EXPECT_GT(run.error, 1.5);
  EXPECT_LT(run.short_error, 1.2);
  EXPECT_TRUE(run.loses_its_way);
  EXPECT_FALSE(run.magnifies);
  const std::vector<Told> texts = HeldOutTexts(run, **model, "next.csv");
  ASSERT_FALSE(texts.empty());
  EXPECT_EQ(texts.front().english.find("magnifies"), std::string::npos) << texts.front().english;
}

/// x' = x / 10 s: what a run begins with grows by a factor of 55 in 40 s.
TEST(HeldOutRun, AStateThatRunsAwayMagnifiesDifferences) {
  std::string text = kSlowStore;
  text.replace(text.find("g*u - k*x"), 9, "g*u + k*x");
  const auto machine = ParseMachine(text, "runaway");
  ASSERT_TRUE(machine) << machine.error().text;
  const auto model = BuildStateModel(*machine, {});
  ASSERT_TRUE(model) << model.error().text;
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 0.01);
  Episode episode;
  episode.signal.setZero(400, 2);
  for (int row = 0; row < 400; ++row) {
    episode.time.push_back(0.1 * row);
    episode.signal(row, 1) = std::exp(0.01 * row) + normal(random);
  }
  const std::span<const Episode> episodes(&episode, 1);
  const Eigen::Vector2d truth(1, 0.1);
  const StateFit fit = FollowStates(*model, episodes, truth, Eigen::VectorXd::Constant(1, 0.01));
  ASSERT_TRUE(fit.solved()) << fit.failed.english;
  const HeldOutRun run = LookAtHeldOut(fit, episodes, fit, episodes, {.more = 0, .as_fitted = 1e9});
  EXPECT_TRUE(run.magnifies);
}

}  // namespace
}  // namespace hydroscope
