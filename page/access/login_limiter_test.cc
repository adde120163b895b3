#include "page/access/login_limiter.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

TEST(LoginLimiter, AfterFiveFailuresANameWaitsFromThere) {
  LoginLimiter limiter;
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(limiter.Wait("anna", "1.1.1.1", k), 0);
    limiter.Failed("anna", "1.1.1.1", k);
  }
  EXPECT_EQ(limiter.Wait("anna", "1.1.1.1", 10), 890);
  EXPECT_EQ(limiter.Wait("anna", "2.2.2.2", 10), 0) << "from elsewhere anna may";
  EXPECT_EQ(limiter.Wait("bert", "1.1.1.1", 10), 0);
  EXPECT_EQ(limiter.Wait("anna", "1.1.1.1", 900.5), 0) << "the first failure is forgotten";
}

TEST(LoginLimiter, AnAddressWaitsWhateverTheNames) {
  LoginLimiter limiter;
  for (int k = 0; k < 20; ++k) limiter.Failed("name" + std::to_string(k), "1.1.1.1", 0);
  EXPECT_GT(limiter.Wait("another", "1.1.1.1", 1), 0);
  EXPECT_EQ(limiter.Wait("another", "2.2.2.2", 1), 0);
}

TEST(LoginLimiter, WhoGotInBeginsAnew) {
  LoginLimiter limiter;
  for (int k = 0; k < 4; ++k) limiter.Failed("anna", "1.1.1.1", 0);
  limiter.Succeeded("anna", "1.1.1.1");
  limiter.Failed("anna", "1.1.1.1", 1);
  EXPECT_EQ(limiter.Wait("anna", "1.1.1.1", 1), 0);
}

TEST(LoginLimiter, RemembersOnlySoMuchAndThenLetsNobodyGuess) {
  LoginLimiter limiter({100, 5, 20, 10});
  for (int k = 0; k < 10; ++k) limiter.Failed("anna", "address" + std::to_string(k), 0);
  EXPECT_GT(limiter.Wait("bert", "another", 1), 0);
  EXPECT_EQ(limiter.Wait("bert", "another", 101), 0);
}

}  // namespace
}  // namespace hydroscope
