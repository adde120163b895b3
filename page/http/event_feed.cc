#include "page/http/event_feed.h"

#include <algorithm>

namespace hydroscope {

void EventFeed::Publish(const std::string& data) { Add("data: " + data + "\n\n"); }

void EventFeed::KeepAlive() { Add(":\n\n"); }

void EventFeed::Add(std::string text) {
  {
    const std::lock_guard lock(mutex_);
    kept_bytes_ += text.size();
    kept_.push_back(std::move(text));
    while (kept_bytes_ > most_bytes_ && kept_.size() > 1) {
      begin_ += kept_.front().size();
      kept_bytes_ -= kept_.front().size();
      kept_.pop_front();
    }
  }
  Wake();
}

void EventFeed::Wake() {
  std::vector<std::function<void()>> woken;
  {
    const std::lock_guard lock(mutex_);
    woken.swap(waiting_);
  }
  for (const auto& wake : woken) wake();
}

void EventFeed::Close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  Wake();
}

EventFeed::Piece EventFeed::Read(std::uint64_t& position, std::size_t most, const std::function<void()>& wait,
                                 const std::function<void()>& wake) {
  const std::lock_guard lock(mutex_);
  std::uint64_t at = begin_;
  // Begins at whole events only: of one that was given up in its middle the rest is gone, and a blank line ends it.
  if (position < begin_) {
    position = begin_;
    return {"\n\n", false};
  }
  for (const std::string& event : kept_) {
    if (position < at + event.size()) {
      Piece piece{event.substr(position - at, most), false};
      position += piece.text.size();
      return piece;
    }
    at += event.size();
  }
  if (closed_) return {"", true};
  wait();
  waiting_.push_back(wake);
  return {};
}

std::uint64_t EventFeed::end() {
  const std::lock_guard lock(mutex_);
  return begin_ + kept_bytes_;
}

}  // namespace hydroscope
