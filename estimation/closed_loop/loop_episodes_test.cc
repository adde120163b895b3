#include "estimation/closed_loop/loop_episodes.h"

#include <gtest/gtest.h>

#include <algorithm>
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
    return Episodes(count, TestCylinderOptions{.seed = 15, .drift = drift});
  }
  std::vector<Episode> Episodes(int count, TestCylinderOptions options) const {
    options.seconds = kSeconds * count;
    options.sample_period = kPeriod;
    const TestCylinderLog log = SimulateTestCylinder(options);
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

  /// Of `count` episodes of another machine, after those of the healthy one.
  std::vector<FollowedEpisode> After(int healthy, int count, const TestCylinderOptions& another) const {
    EpisodeFollower follower(EpisodesOfLoop(machine_, kPeriod));
    for (const Episode& episode : Episodes(healthy)) follower.Add(episode);
    std::vector<FollowedEpisode> followed;
    for (const Episode& episode : Episodes(count, another)) followed.push_back(follower.Add(episode));
    return followed;
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

/// A young follower is fitted anew anyway, these are older.
constexpr int kGrownUp = 12;

TEST_F(LoopFollowing, AnotherValveIsFollowedToItsTruth) {
  const TestCylinderOptions valve = {.zeta_h = kZetaWith38, .K_sv = kGainOf38, .seed = 16};
  const TestCylinderTruth t = TruthOf(valve);
  for (const FollowedEpisode& f : After(kGrownUp, 15, valve)) {
    ASSERT_EQ(f.estimates.size(), 5U);
    EXPECT_NEAR(f.estimates[0].value, t.f_h, 0.06 * t.f_h);
    EXPECT_NEAR(f.estimates[2].value, t.f_sv, 0.12 * t.f_sv);
    EXPECT_NEAR(f.estimates[3].value, t.K_sv, 0.02 * t.K_sv);
    EXPECT_LT(f.estimates[3].std, 0.01 * t.K_sv) << "the change itself is no scatter";
  }
}

TEST_F(LoopFollowing, APoleThatJumpsIsFollowedToItsTruth) {
  const TestCylinderOptions slow = {.f_sv = 72, .seed = 16};
  const TestCylinderTruth t = TruthOf(slow);
  const FollowedEpisode last = After(kGrownUp, 15, slow).back();
  ASSERT_EQ(last.estimates.size(), 5U);
  EXPECT_NEAR(last.estimates[0].value, t.f_h, 0.05 * t.f_h);
  EXPECT_NEAR(last.estimates[2].value, t.f_sv, 0.03 * t.f_sv);
  EXPECT_NEAR(last.estimates[3].value, t.K_sv, 0.02 * t.K_sv);
}

/// What is known sharply seems to move for a remainder that others leave which are led only part of the way.
TEST_F(LoopFollowing, EpisodesOfMoreFrictionSpeakOfDampingAtOnceAndOfNothingElse) {
  const TestCylinderOptions rough = {.zeta_h = 1.4 * 0.9766, .seed = 16};
  const TestCylinderTruth t = TruthOf(rough);
  for (const FollowedEpisode& f : After(kGrownUp, 3, rough)) {
    const EpisodeEvidence& e = f.evidence;
    const Eigen::VectorXd best = e.at + e.information.ldlt().solve(e.gradient);
    EXPECT_NEAR(best[0], t.f_h, 0.1 * t.f_h);
    EXPECT_NEAR(best[1], t.zeta_h, 0.15 * t.zeta_h);
    EXPECT_NEAR(best[2], t.f_sv, 0.25 * t.f_sv);
    EXPECT_NEAR(best[3], t.K_sv, 0.02 * t.K_sv);
  }
}

TEST_F(LoopFollowing, NothingIsStatedBesideALimitOfTheSearch) {
  int at_limit = 0;
  for (const FollowedEpisode& f : After(3, 6, {.f_h = 103, .zeta_h = 2.93, .seed = 16})) {
    const auto said = [&](EstimateReason reason) {
      return std::ranges::count(f.estimates, reason, &Estimate::reason);
    };
    if (said(EstimateReason::kOutsidePhysics) == 0) continue;
    ++at_limit;
    EXPECT_EQ(said(EstimateReason::kUpdated), 0);
    EXPECT_EQ(f.evidence.readings, 0);
  }
  EXPECT_GT(at_limit, 0);
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
