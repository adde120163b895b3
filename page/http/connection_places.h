#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

namespace hydroscope {

/// The places for connections of a port: where all are taken, who asks nothing gives way to who comes, so that connections
/// which are only held open keep nobody out. Of one thread.
class ConnectionPlaces {
 public:
  /// What a connection is for; the earlier ones give way first.
  enum class Use {
    kNothing,    ///< no request came so far, or not all of its head
    kRests,      ///< between two requests of nobody logged in
    kGuest,      ///< a request of nobody logged in is under way
    kUserRests,  ///< between two requests of somebody logged in
    kUser,       ///< a request of somebody logged in is under way; does not give way
  };
  struct Limits {
    std::size_t all;
    std::size_t of_one_address;
  };
  explicit ConnectionPlaces(const Limits& limits) : limits_(limits) {}

  using Id = std::uint64_t;
  /// A connection came. `close`: begins to close it; called at most once, for this one or for another.
  Id Opened(const std::string& address, std::function<void()> close);
  void Uses(Id id, Use use);
  void Closed(Id id);

 private:
  struct Connection {
    std::string address;
    std::function<void()> close;
    Use use = Use::kNothing;
    std::uint64_t since = 0;  ///< turn in which this use began
    bool leaves = false;
  };
  void KeepTo(std::size_t limit, Id newest, const std::string* address);

  Limits limits_;
  std::map<Id, Connection> open_;
  std::uint64_t turn_ = 0;
};

}  // namespace hydroscope
