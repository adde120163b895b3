#include "diagnosis/states/other_causes/missing_dynamics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "diagnosis/states/explain_states.h"
#include "diagnosis/states/other_causes/mass_on_a_spring_fixture.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;

constexpr int kLoadRows = 2500, kLoadSubsteps = 200;
constexpr double kLoadPeriod = 1e-3, kLoadRate = 150, kLoadDamping = 30;  // s, rad/s, 1/s

/// A load under random steps, with a second one on a spring (`coupling`), noise that an autoregression colours, noise on the
/// process, and a controller that takes a share of what is measured back; `wish`: size of the steps.
struct LoadTruth {
  double coupling = 0, colour = 0, process = 0, feedback = 0, wish = 1;
};
Episode Moved(const LoadTruth& truth, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Episode episode;
  episode.signal.resize(kLoadRows, 2);
  double x = 0, v = 0, far = 0, far_v = 0, wish = 0, noise = 0, disturbed = 0;
  for (int row = 0; row < kLoadRows; ++row) {
    if (row % 20 == 0) wish = truth.wish * normal(random);
    noise = truth.colour * noise + std::sqrt(1 - truth.colour * truth.colour) * normal(random);
    disturbed = 0.98 * disturbed + truth.process * normal(random);
    const double y = x + 0.004 * noise, u = wish - truth.feedback * y;
    episode.time.push_back(kLoadPeriod * row);
    episode.signal(row, 0) = u;
    episode.signal(row, 1) = y;
    const double step = kLoadPeriod / kLoadSubsteps, far_rate = 1.5 * kLoadRate;
    for (int k = 0; k < kLoadSubsteps; ++k) {
      const double pull = truth.coupling * kLoadRate * kLoadRate * (far - x);
      v += step * (kLoadRate * kLoadRate * (u + disturbed - x) - kLoadDamping * v + pull);
      x += step * v;
      far_v += step * (far_rate * far_rate * (x - far) - 0.1 * far_rate * far_v);
      far += step * far_v;
    }
  }
  return episode;
}

std::optional<double> Found(const LoadTruth& truth, unsigned seed) {
  const Episode episode = Moved(truth, seed);
  const StateFit fit = FitStates(BuildStateModel(MassOnASpring(), {}).value(), std::span(&episode, 1));
  EXPECT_TRUE(fit.solved()) << fit.failed.english;
  return FindMissingDynamics(fit, RemainderOf(fit, std::span(&episode, 1)), std::span(&episode, 1));
}

TEST(MissingDynamics, ASecondLoadIsToldOfAndNotNamedAsDrag) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const auto share = Found({0.06}, seed);
    ASSERT_TRUE(share) << seed;
    EXPECT_GT(*share, 0.2) << seed;
  }
  const Episode episode = Moved({0.06}, 4);
  const StatesExplanation x = ExplainStates(MassOnASpring(), std::span(&episode, 1));
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_THAT(x.warnings, testing::Contains(testing::Field(&Told::english, HasSubstr("the past of inputs"))));
}

TEST(MissingDynamics, NoiseOfAnyKindIsNone) {
  for (unsigned seed = 1; seed <= 2; ++seed) {
    EXPECT_FALSE(Found({}, seed)) << seed;
    EXPECT_FALSE(Found({.colour = 0.9}, seed)) << seed;
    EXPECT_FALSE(Found({.process = 0.01}, seed)) << seed;
    EXPECT_FALSE(Found({.process = 0.01, .feedback = 0.5}, seed)) << seed;
    EXPECT_FALSE(Found({.colour = 0.9, .feedback = 0.5}, seed)) << seed;
    EXPECT_FALSE(Found({.process = 0.05, .feedback = 0.5, .wish = 0.2}, seed)) << seed;
  }
}

}  // namespace
}  // namespace hydroscope
