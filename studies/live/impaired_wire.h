#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <random>
#include <thread>
#include <vector>

#include "core/result.h"

namespace hydroscope {

/// What a wire does to each frame, in both directions.
struct Impairment {
  double loss = 0;        ///< share of the frames
  double delay = 0;       ///< s
  double overtaking = 0;  ///< share of the frames that go without the delay, and so before earlier ones
  bool cut = false;       ///< nothing passes
};

/// Two network namespaces, each with one card at the end of a wire that this process is: it reads frames from
/// one card (a TAP device) and hands them to the other one, or not. In place of the kernel's netem, which is
/// not in every kernel; and the same seed loses the same frames. Namespaces and cards go with the object.
class ImpairedWire {
 public:
  static constexpr const char* kAddresses[2] = {"10.77.0.1", "10.77.0.2"};

  /// Call it before any thread is started: without the right to make network namespaces it makes a user
  /// namespace of its own. Errors say what is not allowed here.
  static Result<std::unique_ptr<ImpairedWire>> Create(std::uint64_t seed);
  ~ImpairedWire();
  ImpairedWire(const ImpairedWire&) = delete;
  ImpairedWire& operator=(const ImpairedWire&) = delete;

  /// File of the namespace of an end (0 or 1), for setns.
  int network(int end) const { return ends_[end].network; }
  void Set(const Impairment& impairment);
  std::int64_t carried() const { return carried_; }
  std::int64_t lost() const { return lost_; }

 private:
  struct End {
    int card = -1, network = -1;
  };
  struct Frame {
    std::int64_t due = 0;  ///< ns, monotonic
    std::uint64_t number = 0;
    int to = 0;
    std::vector<std::uint8_t> bytes;
    bool operator>(const Frame& other) const {
      return due != other.due ? due > other.due : number > other.number;
    }
  };
  explicit ImpairedWire(std::uint64_t seed) : random_(seed) {}
  static Status OpenEnd(const char* address, End& end);
  void Run(const std::stop_token& stop);
  void Receive(int from, std::vector<Frame>& waiting);

  End ends_[2];
  std::mutex mutex_;
  Impairment impairment_;
  std::mt19937_64 random_;
  std::uint64_t number_ = 0;
  std::atomic<std::int64_t> carried_ = 0, lost_ = 0;
  std::jthread thread_;
};

}  // namespace hydroscope
