#include "core/parallel/in_parallel.h"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <numeric>
#include <string>

namespace hydroscope {
namespace {

TEST(InParallel, GivesWhatEachFindsInTheirOrder) {
  for (const int threads : {1, 3, 64}) {
    const std::vector<std::string> found =
        InParallel(threads, 20, [](std::size_t k) { return std::to_string(k * k); });
    ASSERT_EQ(found.size(), 20u);
    for (std::size_t k = 0; k < found.size(); ++k) EXPECT_EQ(found[k], std::to_string(k * k));
  }
  EXPECT_TRUE(InParallel(4, 0, [](std::size_t) { return 1; }).empty());
}

TEST(InParallel, WorksBesideEachOther) {
  std::mutex mutex;
  std::condition_variable changed;
  std::size_t begun = 0;
  const std::vector<bool> met = InParallel(2, 2, [&](std::size_t) {
    std::unique_lock lock(mutex);
    ++begun;
    changed.notify_all();
    return changed.wait_for(lock, std::chrono::seconds(10), [&] { return begun == 2; });
  });
  EXPECT_EQ(met, std::vector<bool>({true, true}));
}

}  // namespace
}  // namespace hydroscope
