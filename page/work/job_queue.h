#pragma once

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

/// Long work, one piece after the other in a thread of its own. What becomes of each is told to the event feed, one JSON
/// object an event: `job`, `kind`, `state` (waiting, running, done, failed), while running `what` and `share` (0...1),
/// of a failed one `error`.
class JobQueue {
 public:
  /// `niceness` of the thread beyond that of the process.
  explicit JobQueue(EventFeed& feed, int niceness = 0);
  /// Waits for the piece under way; what still waits is forgotten.
  ~JobQueue();

  /// Returns the number of the job. One of the same `key` that still waits takes its place: its number is returned.
  /// Error: too much waits.
  Result<std::int64_t> Add(const std::string& kind, const std::string& key, std::function<Status()> work);
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
  };
  void Run(int niceness);
  void Tell(const Job& job);

  EventFeed& feed_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;  ///< ended ones first
  std::int64_t last_id_ = 0;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace hydroscope
