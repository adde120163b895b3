#include "studies/parallel.h"

#include <ctime>
#include <mutex>

#include "core/parallel/in_parallel.h"

namespace hydroscope {

void ForEachCase(int count, ProgressBar& progress, const std::function<void(int)>& work, int threads) {
  std::mutex mutex;
  int done = 0;
  ForEachInParallel(threads, static_cast<std::size_t>(std::max(count, 0)), [&](std::size_t k) {
    work(static_cast<int>(k));
    const std::lock_guard lock(mutex);
    ++done;
    progress.Update(static_cast<double>(done) / count, done);
  });
}

double ThreadSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace hydroscope
