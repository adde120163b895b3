#pragma once

#include <array>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <thread>

#include "core/result.h"
#include "core/told.h"
#include "page/http/event_feed.h"

namespace hydroscope {

/// Work in threads of its own: long work one piece after the other, and beside it what is done in a moment and must not
/// wait for that. What becomes of each is told to the event feed, one JSON
/// object an event: `job`, `kind`, `state` (waiting, running, done, failed), while running `what` and `share` (0...1),
/// of a failed one `error`.
class JobQueue {
 public:
  enum class Length { kLong, kShort };

  /// `niceness` of long work beyond that of the process.
  explicit JobQueue(EventFeed& feed, int niceness = 0);
  /// Waits for the pieces under way; what still waits is forgotten.
  ~JobQueue();

  /// Returns the number of the job. One of the same `key` that still waits takes its place: its number is returned.
  /// Error: too much waits.
  Result<std::int64_t> Add(const std::string& kind, const std::string& key, std::function<Status()> work,
                           Length length = Length::kLong);
  /// Those that wait or run, and the last that ended, in order.
  nlohmann::json Json() const;

  /// Niceness of work that strokes of a service go before.
  static constexpr int kBesideAService = 10;
  /// Most jobs that wait.
  static constexpr std::size_t kMostWaiting = 32;

 private:
  struct Job {
    std::int64_t id = 0;
    std::string kind, key, state = "waiting", what;
    Told error;
    double share = 0;
    std::function<Status()> work;
    Length length = Length::kLong;
  };
  void Run(Length length, int niceness);
  void Tell(const Job& job);

  EventFeed& feed_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;  ///< ended ones first
  std::int64_t last_id_ = 0;
  bool ending_ = false;
  std::array<std::thread, 2> threads_;
};

}  // namespace hydroscope
