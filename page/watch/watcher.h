#pragma once

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "page/http/event_feed.h"
#include "page/watch/watch_options.h"
#include "page/watch/watched_machine.h"

namespace hydroscope {

/// What is known of a database at a moment; never changed afterwards.
struct WatchedState {
  struct MachineState {
    std::int64_t id = 0, end = 0;
    bool dated = false;
    std::map<std::string, WatchedParameter> parameters;
    std::vector<TrendMark> marks;                     ///< in order of stroke
    std::map<std::string, std::string> signal_units;  ///< SI, by name
  };
  nlohmann::json overview;  ///< docs/page.md, `watch/overview`
  nlohmann::json alarms;    ///< docs/page.md, `watch/alarms`
  nlohmann::json tags;      ///< docs/page.md, `watch/tags`
  std::map<std::string, MachineState> machines;
};

/// Looks at a database and its alarm journal once a second, in a thread of low priority and with handles of its own, and tells
/// the event feed {"state": "watched"} when something changed; while nobody asks, it rests. Only reads; a database that is
/// replaced is opened anew.
class Watcher {
 public:
  Watcher(WatchOptions options, EventFeed& feed);
  ~Watcher();
  /// Never null; its `overview` is null until the database was read first. Keeps the thread at work for kAttention s.
  std::shared_ptr<const WatchedState> state();
  static constexpr double kAttention = 90;
  /// What the service told at the last look; null: none runs. Its ages and counters change while nothing is stored.
  nlohmann::json Service() const;
  /// Looks again at once: something was changed here.
  void LookNow();
  const WatchOptions& options() const { return options_; }

 private:
  struct Opened;
  void Run();
  /// Reads everything if something changed.
  Status Look();
  WatchedState Seen() const;
  Status Open();
  Status Read(Opened& opened, const nlohmann::json& service);
  void Publish(std::shared_ptr<const WatchedState> state);

  const WatchOptions options_;
  EventFeed& feed_;
  std::unique_ptr<Opened> opened_;
  std::string seen_;  ///< what the last picture was made from
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false, look_now_ = false;
  std::int64_t asked_ = 0;  ///< ns, monotonic, when somebody asked last
  std::shared_ptr<const WatchedState> state_;
  nlohmann::json service_;
  std::thread thread_;
};

}  // namespace hydroscope
