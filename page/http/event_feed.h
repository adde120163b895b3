#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace hydroscope {

/// Events for any number of readers, each at its own pace. What is kept is bounded: a reader that stalls loses the events
/// it was too slow for, and nobody waits for it.
class EventFeed {
 public:
  /// Bytes of events that are kept at most, though always the last event.
  explicit EventFeed(std::size_t most_bytes = 256 * 1024) : most_bytes_(most_bytes) {}

  /// Adds an event, one line of text, and wakes the readers that wait.
  void Publish(const std::string& data);
  /// Adds a comment, which keeps streams alive.
  void KeepAlive();
  /// Has the readers that wait look again, whether they may stay.
  void Wake();
  /// No more events: readers read what is there, then get `ended`.
  void Close();

  struct Piece {
    std::string text;  ///< as a stream of server-sent events; "" = nothing now
    bool ended = false;
  };
  /// At most `most` bytes from byte `position` of the stream on, which moves along. If there is nothing, `wait` is called
  /// before anything can be added, so that no wake-up is lost; `wake` then runs once, at the next Publish, Wake or Close.
  Piece Read(std::uint64_t& position, std::size_t most, const std::function<void()>& wait,
             const std::function<void()>& wake);
  /// The position behind all that was published.
  std::uint64_t end();

 private:
  void Add(std::string text);

  const std::size_t most_bytes_;
  std::mutex mutex_;
  std::deque<std::string> kept_;
  std::size_t kept_bytes_ = 0;
  std::uint64_t begin_ = 0;  ///< position of the first byte kept
  bool closed_ = false;
  std::vector<std::function<void()>> waiting_;
};

}  // namespace hydroscope
