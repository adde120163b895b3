#include "studies/parallel.h"

#include <algorithm>
#include <atomic>
#include <ctime>
#include <mutex>
#include <thread>
#include <vector>

namespace hydroscope {

void ForEachCase(int count, ProgressBar& progress, const std::function<void(int)>& work, int threads) {
  std::atomic<int> next = 0;
  std::mutex mutex;
  int done = 0;
  const auto run = [&] {
    for (int k = next++; k < count; k = next++) {
      work(k);
      std::lock_guard lock(mutex);
      ++done;
      progress.Update(static_cast<double>(done) / count, done);
    }
  };
  const int most = threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::vector<std::jthread> others;
  for (int t = 1; t < std::min(most, count); ++t) others.emplace_back(run);
  run();
}

double ThreadSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace hydroscope
