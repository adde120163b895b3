#include "estimation/closed_loop/loop_episodes.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "estimation/recursive/episode_follower.h"
#include "simulator/test_cylinder/test_cylinder.h"

namespace hydroscope {
namespace {

/// The simulated test cylinder in episodes of 5 s, rows 1 ms apart.
class LoopFollowing : public ::testing::Test {
 protected:
  static constexpr double kPeriod = 1e-3, kSeconds = 5;

  LoopFollowing()
      : machine_(*LoadMachine(std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/test_cylinder.toml")) {}

  std::vector<Episode> Episodes(int count, const TestCylinderDrift& drift = {}) const {
    const TestCylinderLog log = SimulateTestCylinder(
        {.seconds = kSeconds * count, .sample_period = kPeriod, .seed = 15, .drift = drift});
    const int rows = static_cast<int>(kSeconds / kPeriod);
    std::vector<Episode> episodes(static_cast<std::size_t>(count));
    for (std::size_t e = 0; e < episodes.size(); ++e) {
      episodes[e].signal.resize(rows, 3);
      for (int row = 0; row < rows; ++row) {
        const std::size_t at = e * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row);
        episodes[e].time.push_back(log.t[at]);
        episodes[e].signal.row(row) << log.z_set[at], log.I_v[at], log.z[at];
      }
    }
    return episodes;
  }

  Machine machine_;
};

TEST_F(LoopFollowing, HoldsTheTruthInItsIntervals) {
  EpisodeFollower follower(EpisodesOfLoop(machine_, kPeriod));
  const TestCylinderTruth t = TruthOf({});
  const std::array<double, 5> truth = {t.f_h, t.zeta_h, t.f_sv, t.K_sv, t.T_d};
  int inside = 0, all = 0;
  for (const Episode& episode : Episodes(30)) {
    const FollowedEpisode f = follower.Add(episode);
    ASSERT_EQ(f.estimates.size(), truth.size());
    for (std::size_t p = 0; p < truth.size(); ++p, ++all)
      inside += std::abs(f.estimates[p].value - truth[p]) < 1.96 * f.estimates[p].std;
  }
  EXPECT_GT(inside, 0.9 * all);
  EXPECT_EQ(follower.Add(Episodes(1)[0]).estimates[4].reason, EstimateReason::kUpdated)
      << "a delay that is none is known as such";
}

/// Poles that are hardly told apart would follow a gain that moves, if episodes were linearised where the gain lags behind.
TEST_F(LoopFollowing, AGainThatFallsTakesNoPolesAlong) {
  EpisodeFollower follower(EpisodesOfLoop(machine_, kPeriod));
  constexpr int kEpisodes = 60;
  FollowedEpisode last;
  for (const Episode& episode : Episodes(kEpisodes, {.K_sv = -0.1 / (40 * kSeconds), .from = 20 * kSeconds}))
    last = follower.Add(episode);
  EXPECT_NEAR(last.estimates[0].value, 343, 0.05 * 343);
  EXPECT_NEAR(last.estimates[2].value, 160, 0.1 * 160);
  EXPECT_NEAR(last.estimates[3].value, 0.9 * 0.0114, 0.02 * 0.0114);
}

TEST_F(LoopFollowing, SaysNothingWhereNothingIsExcited) {
  std::vector<Episode> episodes = Episodes(1);
  episodes[0].signal.col(0).setConstant(0.001);
  EpisodeFollower follower(EpisodesOfLoop(machine_, kPeriod));
  EXPECT_TRUE(follower.Add(episodes[0]).estimates.empty());
  EXPECT_EQ(follower.Add(episodes[0]).evidence.readings, 0);
}

}  // namespace
}  // namespace hydroscope
