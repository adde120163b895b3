#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <optional>
#include <thread>
#include <type_traits>
#include <vector>

namespace hydroscope {

/// Threads that work is shared out on: `asked`, 0: as many as the computer has cores.
inline int ThreadsOf(int asked) {
  return asked > 0 ? asked : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

/// Calls `work` for 0 ... count - 1, on this thread and up to `threads` - 1 others (ThreadsOf). Which does which is open: `work`
/// touches nothing that another call changes. It must not throw.
template <class Work>
void ForEachInParallel(int threads, std::size_t count, const Work& work) {
  std::atomic<std::size_t> next = 0;
  const auto run = [&] {
    for (std::size_t k = next++; k < count; k = next++) work(k);
  };
  std::vector<std::jthread> others;
  for (std::size_t t = 1; t < std::min(static_cast<std::size_t>(ThreadsOf(threads)), count); ++t)
    others.emplace_back(run);
  run();
}

/// What `work` gives for 0 ... count - 1, in this order, on however many threads (ForEachInParallel).
template <class Work>
auto InParallel(int threads, std::size_t count, const Work& work) {
  using Given = std::invoke_result_t<const Work&, std::size_t>;
  std::vector<std::optional<Given>> given(count);
  ForEachInParallel(threads, count, [&](std::size_t k) { given[k].emplace(work(k)); });
  std::vector<Given> out;
  out.reserve(count);
  for (std::optional<Given>& one : given) out.push_back(std::move(*one));
  return out;
}

}  // namespace hydroscope
