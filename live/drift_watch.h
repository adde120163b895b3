#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "alarms/health_board.h"
#include "core/clock.h"
#include "live/live_status.h"
#include "monitor/press_monitor.h"

namespace hydroscope {

/// Judges what the live service stores, on a thread and with database handles of its own: PressMonitor over
/// the stored strokes, and what only a running service knows - channels that fall silent, a press that idles,
/// a valve being swept.
class DriftWatch {
 public:
  struct Inputs {
    std::function<LiveStatus()> status;
    std::function<int()> checked_axis;             ///< -1: none
    std::shared_ptr<HealthBoard> board = nullptr;  ///< is told health and statements of each axis
  };
  DriftWatch(std::unique_ptr<PressMonitor> press, Inputs inputs, Clock clock);
  ~DriftWatch() { Stop(); }

  void Start();
  void Stop();
  /// After Stop(), and after the service has stored its last strokes: judges these.
  void Finish();
  /// Goes on with another one: limits or rules have changed. Nothing is lost, all state lies in the journal.
  void Replace(std::unique_ptr<PressMonitor> press);
  DriftWatchStatus status() const;

 private:
  /// What is known of an axis between two looks.
  struct Axis {
    std::int64_t strokes = 0;
    std::int64_t changed = 0;  ///< ns, monotonic, when `strokes` last grew
    std::int64_t rows = 0;
    std::int64_t silent_since = 0;  ///< ns, monotonic; 0: nothing is missing
    std::int64_t stated = -1;  ///< `strokes` when it was last asked how its estimates are stated; -1: never
    bool idle = false, checked = false;
  };
  void Run();
  Status Look(HostTime now);
  Status LookAtAxis(int index, const LiveStatus& live, HostTime now);
  Status LookForSilence(int index, const LiveStatus& live, HostTime now);
  Status LookForSecondSender(int index, const LiveStatus& live, HostTime now);
  Status Tell(int index, const char* alarm, const std::optional<AlarmCondition>& condition, HostTime now);
  void StateNext(HostTime now);
  void Publish(const Status& done);

  std::unique_ptr<PressMonitor> press_;
  Inputs inputs_;
  Clock clock_;
  std::vector<Axis> axes_;
  std::int64_t looked_ = 0;
  std::size_t state_from_ = 0;    ///< axis that is asked first how its estimates are stated
  std::int64_t state_after_ = 0;  ///< ns, monotonic, before which none is
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  DriftWatchStatus status_;
  std::unique_ptr<PressMonitor> replacement_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace hydroscope
