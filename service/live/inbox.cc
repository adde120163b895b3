#include "service/live/inbox.h"

#include <algorithm>
#include <chrono>

namespace hydroscope {

void Inbox::Push(int source, SampleBatch&& batch) {
  {
    std::lock_guard lock(mutex_);
    counters_.values += static_cast<std::int64_t>(batch.values.size());
    entries_.push_back({source, std::move(batch)});
    if (counters_.values > capacity_)
      while (counters_.values > capacity_ / 2 && entries_.size() > 1) {
        const auto values = static_cast<std::int64_t>(entries_.front().batch.values.size());
        counters_.values -= values;
        counters_.dropped_values += values;
        ++counters_.dropped_batches;
        entries_.pop_front();
      }
    counters_.most_values = std::max(counters_.most_values, counters_.values);
  }
  filled_.notify_one();
}

std::vector<Inbox::Entry> Inbox::TakeAll(double seconds) {
  std::unique_lock lock(mutex_);
  filled_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return !entries_.empty(); });
  std::vector<Entry> taken(std::make_move_iterator(entries_.begin()),
                           std::make_move_iterator(entries_.end()));
  entries_.clear();
  counters_.values = 0;
  return taken;
}

Inbox::Counters Inbox::counters() const {
  std::lock_guard lock(mutex_);
  Counters counters = counters_;
  counters.batches = static_cast<std::int64_t>(entries_.size());
  return counters;
}

}  // namespace hydroscope
