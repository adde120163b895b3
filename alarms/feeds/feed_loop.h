#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include "core/result.h"
#include "core/told_error.h"

namespace hydroscope {

inline constexpr double kLookPeriod = 0.1;                     ///< s between two looks at the journal
inline constexpr std::int64_t kPicturePeriod = 1'000'000'000;  ///< ns between two looks at axes without news

/// The thread of a feed: one round after the other. A round that fails is counted, its error kept for the
/// status, and the next one waits for `kPatience` seconds.
class FeedLoop {
 public:
  static constexpr double kPatience = 1;

  /// `period` in s between the end of a round and the next, unless Wake() is called.
  FeedLoop(double period, std::function<Status()> round)
      : period_(period), round_(std::move(round)), thread_([this](std::stop_token stop) { Run(stop); }) {}

  void Wake() {
    {
      std::lock_guard lock(mutex_);
      woken_ = true;
    }
    wake_.notify_all();
  }
  std::int64_t errors() const {
    std::lock_guard lock(mutex_);
    return errors_;
  }
  /// Of the last round; "" if it went well.
  Told problem() const {
    std::lock_guard lock(mutex_);
    return problem_;
  }
  /// Waits for the round under way.
  void Stop() { thread_ = {}; }

 private:
  void Run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      const Status done = round_();
      std::unique_lock lock(mutex_);
      errors_ += done ? 0 : 1;
      problem_ = done ? Told() : ToldOf(done.error());
      wake_.wait_for(lock, stop, std::chrono::duration<double>(done ? period_ : kPatience),
                     [&] { return woken_ && done.has_value(); });
      woken_ = false;
    }
  }

  double period_;
  std::function<Status()> round_;
  mutable std::mutex mutex_;
  std::condition_variable_any wake_;
  bool woken_ = false;
  std::int64_t errors_ = 0;
  Told problem_;
  std::jthread thread_;
};

}  // namespace hydroscope
