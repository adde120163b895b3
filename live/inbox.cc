#include "live/inbox.h"

#include <algorithm>
#include <chrono>

namespace hydroscope {

void Inbox::Push(int source, SampleBatch&& batch) {
  {
    std::lock_guard lock(mutex_);
    const auto values = static_cast<std::int64_t>(batch.values.size());
    counters_.values += values;
    waiting_[{source, batch.writer, batch.session}] += values;
    entries_.push_back({source, std::move(batch)});
    while (counters_.values > capacity_ && entries_.size() > 1)
      DropHalf(std::max_element(waiting_.begin(), waiting_.end(), [](const auto& a, const auto& b) {
                 return a.second < b.second;
               })->first);
    counters_.most_values = std::max(counters_.most_values, counters_.values);
  }
  filled_.notify_one();
}

void Inbox::DropHalf(const Lane& lane) {
  std::int64_t& waiting = waiting_[lane];
  const std::int64_t kept = waiting / 2;
  std::erase_if(entries_, [&](const Entry& entry) {
    if (waiting <= kept || Lane(entry.source, entry.batch.writer, entry.batch.session) != lane) return false;
    const auto values = static_cast<std::int64_t>(entry.batch.values.size());
    waiting -= values;
    counters_.values -= values;
    counters_.dropped_values += values;
    counters_.dropped_by_source[std::get<0>(lane)] += values;
    ++counters_.dropped_batches;
    return true;
  });
}

std::vector<Inbox::Entry> Inbox::TakeAll(double seconds) {
  std::unique_lock lock(mutex_);
  filled_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return !entries_.empty(); });
  std::vector<Entry> taken(std::make_move_iterator(entries_.begin()),
                           std::make_move_iterator(entries_.end()));
  entries_.clear();
  waiting_.clear();
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
