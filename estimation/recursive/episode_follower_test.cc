#include "estimation/recursive/episode_follower.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <span>

#include "estimation/states/state_episodes.h"

namespace hydroscope {
namespace {

/// x' = -k x + u, y = g x, held inputs; the truth of each episode is exact.
class StateFollowing : public ::testing::Test {
 protected:
  StateFollowing() {
    const auto machine = ParseMachine(R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "V" }
[states]
x = { ddt = "-k*x + u", initial = "estimate" }
[outputs]
y = "g*x"
[parameters]
k = { start = 1, min = 0.1, max = 10 }
g = { start = 1, min = 0.1, max = 10 }
)toml",
                                      "lag.toml");
    EXPECT_TRUE(machine) << (machine ? "" : machine.error().text);
    model_ = EpisodesOfStates(*BuildStateModel(*machine, {}));
  }

  /// 200 rows of 0.05 s; `memory`: of the noise from row to row.
  Episode Rows(double k, double g, double amplitude, double memory = 0) {
    constexpr double kPeriod = 0.05, kNoise = 0.01;
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> level(-1, 1);
    Episode episode;
    episode.signal.resize(200, 2);
    double u = 0, error = 0;
    for (int row = 0; row < 200; ++row) {
      if (row % 10 == 0) u = amplitude * level(random_);
      error = memory * error + std::sqrt(1 - memory * memory) * kNoise * normal(random_);
      episode.time.push_back(kPeriod * static_cast<double>(row_++));
      episode.signal(row, 0) = u;
      episode.signal(row, 1) = g * x_ + error;
      const double e = std::exp(-k * kPeriod);
      x_ = x_ * e + u / k * (1 - e);
    }
    return episode;
  }

  std::shared_ptr<const EpisodeModel> model_;
  std::mt19937 random_{3};
  std::int64_t row_ = 0;
  double x_ = 0;
};

TEST_F(StateFollowing, HoldsTheTruthInItsIntervals) {
  for (const double memory : {0.0, 0.9}) {
    EpisodeFollower follower(model_);
    int inside = 0, judged = 0;
    for (int e = 0; e < 120; ++e) {
      const FollowedEpisode f = follower.Add(Rows(2, 1.5, 1, memory));
      ASSERT_EQ(f.estimates.size(), 2u);
      if (e < 10) continue;
      for (const auto& [estimate, truth] :
           {std::pair(&f.estimates[0], 2.0), std::pair(&f.estimates[1], 1.5)}) {
        EXPECT_EQ(estimate->reason, EstimateReason::kUpdated);
        inside += std::abs(estimate->value - truth) < 1.96 * estimate->std;
        ++judged;
        EXPECT_LT(estimate->std, 0.05 * truth);
      }
    }
    // Neighbouring estimates share episodes, so that few of them are independent.
    EXPECT_GT(inside, 0.85 * judged) << "noise remembers " << memory;
  }
}

TEST_F(StateFollowing, FollowsADriftFarFromWhereItBegan) {
  EpisodeFollower follower(model_);
  int inside = 0;
  double k = 2;
  for (int e = 0; e < 150; ++e, k *= 1.006) {
    const FollowedEpisode f = follower.Add(Rows(k, 1.5, 1));
    EXPECT_NEAR(f.estimates[0].value, k, 0.06 * k);
    inside += std::abs(f.estimates[0].value - k) < 1.96 * f.estimates[0].std;
  }
  EXPECT_GT(k, 4.5) << "linearised about the first fit alone this would be lost";
  EXPECT_GT(inside, 0.85 * 150);
}

TEST_F(StateFollowing, HoldsAParameterInItsIntervalsFromTheEpisodeOnThatItMoves) {
  EpisodeFollower follower(model_);
  double k = 2;
  for (int e = 0; e < 60; ++e) follower.Add(Rows(k, 1.5, 1));
  int inside = 0;
  for (int e = 0; e < 20; ++e) {
    k *= 1.02;
    const FollowedEpisode f = follower.Add(Rows(k, 1.5, 1));
    inside += std::abs(f.estimates[0].value - k) < 1.96 * f.estimates[0].std;
    EXPECT_LT(f.estimates[0].std, 0.1 * k);
  }
  EXPECT_GE(inside, 18) << "of 20, and not only once their scatter has told";
}

TEST_F(StateFollowing, LeavesToThePastWhatAnEpisodeDoesNotSee) {
  EpisodeFollower follower(model_);
  FollowedEpisode seen, rest;
  for (int e = 0; e < 10; ++e) seen = follower.Add(Rows(2, 1.5, 1));
  for (int e = 0; e < 5; ++e) {
    x_ = 0;
    rest = follower.Add(Rows(2, 1.5, 0));
  }
  for (int p = 0; p < 2; ++p) {
    const Estimate &before = seen.estimates[static_cast<std::size_t>(p)],
                   &now = rest.estimates[static_cast<std::size_t>(p)];
    EXPECT_EQ(now.reason, EstimateReason::kNotExcited);
    EXPECT_NEAR(now.value, before.value, 0.2 * before.std);
    EXPECT_EQ(now.last_excited, before.last_excited);
  }
}

TEST_F(StateFollowing, BeginsAnewWhereTheFirstEpisodeToldNothing) {
  EpisodeFollower follower(model_);
  follower.Add(Rows(2, 1.5, 0));
  FollowedEpisode last;
  for (int e = 0; e < 10; ++e) last = follower.Add(Rows(2, 1.5, 1));
  EXPECT_NEAR(last.estimates[0].value, 2, 0.1);
  EXPECT_NEAR(last.estimates[1].value, 1.5, 0.1);
}

TEST_F(StateFollowing, GoesOnFromASavedStateBitByBit) {
  EpisodeFollower follower(model_);
  for (int e = 0; e < 5; ++e) follower.Add(Rows(2, 1.5, 1));
  ByteWriter out;
  follower.Save(out);
  const std::vector<std::uint8_t> bytes = out.Take();
  EpisodeFollower again(model_);
  ByteReader in(bytes);
  ASSERT_TRUE(again.Restore(in));
  const Episode next = Rows(2.1, 1.5, 1);
  const FollowedEpisode a = follower.Add(next), b = again.Add(next);
  for (std::size_t p = 0; p < 2; ++p) {
    EXPECT_EQ(a.estimates[p].value, b.estimates[p].value);
    EXPECT_EQ(a.estimates[p].std, b.estimates[p].std);
  }
  ByteReader torn(std::span<const std::uint8_t>(bytes).first(bytes.size() / 2));
  EXPECT_FALSE(EpisodeFollower(model_).Restore(torn));
}

/// To first order the errors at other parameters are those that a run at them gives.
TEST_F(StateFollowing, SaysWhatOtherParametersWouldLeave) {
  EpisodeFollower follower(model_);
  follower.Add(Rows(2, 1.5, 1));
  const FollowedEpisode f = follower.Add(Rows(2, 1.5, 1));
  const Eigen::VectorXd other = f.evidence.at.cwiseProduct(Eigen::Vector2d(1.02, 0.99));
  const Episode same = Rows(2, 1.5, 1);
  EXPECT_GT(f.evidence.ErrorAt(other), 1.05 * f.evidence.ErrorAt(f.evidence.at));
  EXPECT_GT(f.evidence.ErrorAt(f.evidence.at), 0.8);
  EXPECT_LT(f.evidence.ErrorAt(f.evidence.at), 1.2);
}

}  // namespace
}  // namespace hydroscope
