#include "host/signals.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <thread>

namespace hydroscope {
namespace {

TEST(Signals, ReachTheThreadThatWaitsThoughOthersWereThereBefore) {
  std::atomic<bool> done = false;
  const auto idle = [&] {
    while (!done) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  std::jthread first(idle), second(idle);  // block nothing
  const sigset_t signals = LeaveToSignalWait({SIGUSR1});
  for (int k = 0; k < 3; ++k) {
    ASSERT_EQ(kill(getpid(), SIGUSR1), 0);
    const timespec patience{10, 0};
    EXPECT_EQ(sigtimedwait(&signals, nullptr, &patience), SIGUSR1);
  }
  done = true;
}

}  // namespace
}  // namespace hydroscope
