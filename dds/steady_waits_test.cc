#include "dds/steady_waits.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <semaphore.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <ctime>
#include <thread>

namespace {
std::atomic<long> g_step = 0;  // s by which the computer's clock was stepped
}

/// The clock as this test's process sees it.
extern "C" int clock_gettime(clockid_t clock, timespec* now) noexcept {
  const long failed = syscall(SYS_clock_gettime, clock, now);
  if (clock == CLOCK_REALTIME) now->tv_sec += g_step;
  return static_cast<int>(failed);
}

namespace hydroscope {
namespace {

using Steady = std::chrono::steady_clock;

timespec In(double s) {
  timespec until{};
  clock_gettime(CLOCK_REALTIME, &until);
  const long ns = until.tv_nsec + std::lround(s * 1e9);
  return {until.tv_sec + ns / 1'000'000'000, ns % 1'000'000'000};
}
double Since(Steady::time_point begin) {
  return std::chrono::duration<double>(Steady::now() - begin).count();
}

class SteadyWaits : public ::testing::TestWithParam<long> {
 protected:
  ~SteadyWaits() override { g_step = 0; }
};

TEST_P(SteadyWaits, ALockWaitsAsLongAsItShallWhateverTheClockOfTheComputerShows) {
  pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
  pthread_mutex_lock(&mutex);
  g_step = GetParam();
  int result = 0;
  double waited = 0;
  std::thread([&] {
    const auto begin = Steady::now();
    const timespec until = In(0.1);
    result = pthread_mutex_timedlock(&mutex, &until);
    waited = Since(begin);
  }).join();
  EXPECT_EQ(result, ETIMEDOUT);
  EXPECT_GT(waited, 0.09);
  EXPECT_LT(waited, 5);
  pthread_mutex_unlock(&mutex);
}

TEST_P(SteadyWaits, ASemaphoreToo) {
  sem_t semaphore;
  sem_init(&semaphore, 0, 0);
  g_step = GetParam();
  const auto begin = Steady::now();
  const timespec until = In(0.1);
  EXPECT_EQ(sem_timedwait(&semaphore, &until), -1);
  EXPECT_EQ(errno, ETIMEDOUT);
  EXPECT_GT(Since(begin), 0.09);
  EXPECT_LT(Since(begin), 5);
  sem_destroy(&semaphore);
}

INSTANTIATE_TEST_SUITE_P(Steps, SteadyWaits, ::testing::Values(0, -7200));

TEST(SteadyWait, TheLibraryMeetsTheseFunctions) { EXPECT_TRUE(TimedWaitsAreSteady()); }

}  // namespace
}  // namespace hydroscope
