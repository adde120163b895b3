#include "dds/steady_waits.h"

#include <dlfcn.h>
#include <pthread.h>
#include <semaphore.h>

#include <algorithm>
#include <cstdint>
#include <ctime>

namespace hydroscope {
namespace {

constexpr std::int64_t kNanoseconds = 1'000'000'000;

std::int64_t Nanoseconds(const timespec& t) { return t.tv_sec * kNanoseconds + t.tv_nsec; }

std::int64_t Now(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return Nanoseconds(now);
}

/// The monotonic clock when the computer's, as it goes now, will show `until`.
timespec Monotonic(const timespec& until) {
  const std::int64_t left = std::max<std::int64_t>(0, Nanoseconds(until) - Now(CLOCK_REALTIME));
  const std::int64_t end = Now(CLOCK_MONOTONIC) + left;
  return {end / kNanoseconds, end % kNanoseconds};
}

}  // namespace

bool TimedWaitsAreSteady() {
  return dlsym(RTLD_DEFAULT, "sem_timedwait") == reinterpret_cast<void*>(&sem_timedwait) &&
         dlsym(RTLD_DEFAULT, "pthread_mutex_timedlock") == reinterpret_cast<void*>(&pthread_mutex_timedlock);
}

}  // namespace hydroscope

extern "C" {

int sem_timedwait(sem_t* semaphore, const timespec* until) {
  const timespec end = hydroscope::Monotonic(*until);
  return sem_clockwait(semaphore, CLOCK_MONOTONIC, &end);
}

int pthread_mutex_timedlock(pthread_mutex_t* mutex, const timespec* until) noexcept {
  const timespec end = hydroscope::Monotonic(*until);
  return pthread_mutex_clocklock(mutex, CLOCK_MONOTONIC, &end);
}

}  // extern "C"
