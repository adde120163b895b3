#include "acquisition/clock_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace hydroscope {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// Messages every 10 ms for `seconds`, each delayed by 0.2 ms and an exponential waiting time of mean 2 ms.
void Feed(ClockModel& model, std::int64_t offset, double drift, double seconds) {
  std::mt19937_64 random(3);
  std::exponential_distribution<double> wait(1 / 2e6);
  for (std::int64_t sent = 0; sent < static_cast<std::int64_t>(seconds * 1e9); sent += 10 * kMs)
    model.Observe(sent, sent + offset + std::llround(drift * static_cast<double>(sent)) + 200'000 +
                            std::llround(wait(random)));
}

TEST(ClockModel, FindsTheOffsetBehindQueueingDelays) {
  ClockModel model;
  Feed(model, 7 * kSecond, 0, 20);
  EXPECT_NEAR(static_cast<double>(model.ToHost(10 * kSecond)), 17.0002e9, 0.1e6);
}

TEST(ClockModel, FollowsAClockThatRunsFast) {
  ClockModel model;
  Feed(model, -kSecond, 80e-6, 120);
  EXPECT_NEAR(model.drift(), 80e-6, 3e-6);
  EXPECT_NEAR(static_cast<double>(model.ToHost(120 * kSecond)), 119e9 + 80e-6 * 120e9 + 0.2e6, 0.2e6);
}

TEST(ClockModel, ALateMessageDoesNotMoveIt) {
  ClockModel model;
  Feed(model, kSecond, 0, 5);
  const std::int64_t before = model.ToHost(5 * kSecond);
  model.Observe(5 * kSecond, 5 * kSecond + 61 * kSecond);
  EXPECT_EQ(model.ToHost(5 * kSecond), before);
}

TEST(ClockModel, IsTheIdentityBeforeTheFirstMessage) { EXPECT_EQ(ClockModel().ToHost(42), 42); }

}  // namespace
}  // namespace hydroscope
