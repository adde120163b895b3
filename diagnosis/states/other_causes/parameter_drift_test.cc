#include "diagnosis/states/other_causes/parameter_drift.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "diagnosis/states/explain_states.h"
#include "diagnosis/states/other_causes/mass_on_a_spring_fixture.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kSwingRows = 3000, kSwingSubsteps = 10;
constexpr double kSwingPeriod = 1e-3, kSwingRate = 200, kSwingDamping = 20;  // s, rad/s, 1/s

/// An oscillator whose rate grows by a share over the log, under steps; with noise on its process, or none.
Episode Swung(double growth, double process_noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Episode episode;
  episode.signal.resize(kSwingRows, 2);
  double x = 0, v = 0, u = 0;
  for (int row = 0; row < kSwingRows; ++row) {
    if (row % 25 == 0) u = normal(random);
    episode.time.push_back(kSwingPeriod * row);
    episode.signal(row, 0) = u;
    episode.signal(row, 1) = x + 0.005 * normal(random);
    const double step = kSwingPeriod / kSwingSubsteps, rate = kSwingRate * (1 + growth * row / kSwingRows);
    v += process_noise * normal(random);
    for (int k = 0; k < kSwingSubsteps; ++k) {
      v += step * (rate * rate * (u - x) - kSwingDamping * v);
      x += step * v;
    }
  }
  return episode;
}

TEST(ParameterDrift, OneThatMovesWithinTheLogIsToldWithItsSizeAndNoAllClearIsGiven) {
  for (const double growth : {0.03, -0.06}) {
    const Episode episode = Swung(growth, 0, 3);
    const StateFit fit = FitStates(BuildStateModel(MassOnASpring(), {}).value(), std::span(&episode, 1));
    const auto drift = FindParameterDrift(fit, RemainderOf(fit, std::span(&episode, 1)));
    ASSERT_TRUE(drift) << growth;
    EXPECT_EQ(drift->moved.front().parameter, "w0");
    EXPECT_NEAR(drift->moved.front().change, growth, 4 * drift->moved.front().std + 0.1 * std::abs(growth));
    EXPECT_GT(drift->share, 0.3);

    const StatesExplanation x = ExplainStates(MassOnASpring(), std::span(&episode, 1));
    EXPECT_EQ(x.verdict, Verdict::kUnknown) << growth;
    EXPECT_THAT(x.set, IsEmpty());
    ASSERT_FALSE(x.warnings.empty());
    EXPECT_THAT(x.warnings.back().english, HasSubstr("w0 by"));
  }
}

TEST(ParameterDrift, NoiseOfSensorOrProcessIsNone) {
  for (unsigned seed = 1; seed <= 8; ++seed)
    for (const double process : {0.0, 3.0}) {
      const Episode episode = Swung(0, process, seed);
      const StateFit fit = FitStates(BuildStateModel(MassOnASpring(), {}).value(), std::span(&episode, 1));
      EXPECT_FALSE(FindParameterDrift(fit, RemainderOf(fit, std::span(&episode, 1))))
          << seed << " " << process;
    }
}

TEST(ParameterDrift, OneNearZeroIsToldInItsUnit) {
  ParameterDrift drift;
  drift.moved = {{"k", -0.2, 0.01, ""}, {"F_0", 12, 1, "N"}};
  EXPECT_THAT(ParameterDriftText(drift).english,
              testing::HasSubstr("k by -20.0 ± 2.0 %, or F_0 by +12.0 ± 2.0 N from begin to end"));
}

}  // namespace
}  // namespace hydroscope
