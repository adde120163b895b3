#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <utility>
#include <vector>

#include "acquisition/source.h"

namespace hydroscope {

/// Bounded queue between the threads of the sources and the pipeline. When it is full, the older half goes at
/// once: what remains is one piece, so that the newest strokes stay whole, instead of holes in every one.
class Inbox {
 public:
  struct Entry {
    int source = 0;
    SampleBatch batch;
  };
  struct Counters {
    std::int64_t batches = 0, values = 0;                  ///< waiting
    std::int64_t most_values = 0;                          ///< that ever waited
    std::int64_t dropped_batches = 0, dropped_values = 0;  ///< since the start
  };

  explicit Inbox(std::int64_t capacity) : capacity_(capacity) {}  ///< values (rows times channels)

  void Push(int source, SampleBatch&& batch);
  /// Everything that waits; empty after `seconds` without anything.
  std::vector<Entry> TakeAll(double seconds);
  Counters counters() const;

 private:
  const std::int64_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable filled_;
  std::deque<Entry> entries_;
  Counters counters_;
};

}  // namespace hydroscope
