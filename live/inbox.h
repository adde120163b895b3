#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <tuple>
#include <vector>

#include "acquisition/source.h"

namespace hydroscope {

/// Bounded queue between the threads of the sources and the pipeline. Each sender has a lane of its own. When
/// the queue is full, the older half of the fullest lane goes at once: what remains of it is one piece, so
/// that the newest strokes stay whole instead of having holes each, and who sends little loses nothing to who sends much.
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
    std::map<int, std::int64_t> dropped_by_source;         ///< values; sources that lost none are not named
  };

  explicit Inbox(std::int64_t capacity) : capacity_(capacity) {}  ///< values (rows times channels)

  void Push(int source, SampleBatch&& batch);
  /// Everything that waits, in the order it came; empty after `seconds` without anything.
  std::vector<Entry> TakeAll(double seconds);
  Counters counters() const;

 private:
  using Lane = std::tuple<int, std::uint64_t, std::uint64_t>;  ///< source, writer, session
  void DropHalf(const Lane& lane);

  const std::int64_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable filled_;
  std::deque<Entry> entries_;
  std::map<Lane, std::int64_t> waiting_;  ///< values
  Counters counters_;
};

}  // namespace hydroscope
