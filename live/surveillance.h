#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "alarms/feeds/feeds.h"
#include "core/told.h"
#include "live/drift_watch.h"
#include "live/event_log.h"
#include "live/live_service.h"
#include "live/service_watch.h"
#include "live/valve_checks.h"
#include "live/write_ahead_logs.h"
#include "storage/file_identity.h"

namespace hydroscope {

/// All that reads what the service stores and tells others: drift watch and journal, feeds, alarms of the
/// service itself, the log. When the writer had to begin another database, or the journal was taken away, all
/// of it begins anew, since each has the lost file open.
class Surveillance {
 public:
  /// Pairs journal and database, and starts the feeds. `service` and `checks` outlive it.
  Surveillance(LiveService& service, ValveChecks& checks, const LiveOptions& options, Clock clock);
  ~Surveillance();

  /// Starts the drift watch; once the service runs.
  void Start();
  /// What there is to tell about the service itself; once a second. False: files that belong to a database in use were deleted
  /// (WriteAheadLogs), and the service has to close it and begin again.
  bool Look();
  /// Goes on with another machine file or other rules.
  void Reload(const Machine& machine);
  /// Goes on with the models that were promoted meanwhile.
  void TakePromotions() { Reload(machine_); }
  /// Ends the drift watch; Finish judges what was stored since.
  void Stop();
  void Finish();
  /// From any thread.
  LiveStatus status() const;

 private:
  void Begin();
  void BeginAnew(const Told& why);
  std::unique_ptr<PressMonitor> MakePressMonitor();
  Result<std::unique_ptr<PressMonitor>> MakeJudge() const;
  Told WhyNotJudged() const;
  DriftWatchStatus Drift() const;
  std::string press() const;

  LiveService& service_;
  ValveChecks& checks_;
  LiveOptions options_;
  Clock clock_;
  Machine machine_;
  std::shared_ptr<HealthBoard> board_ = std::make_shared<HealthBoard>();
  std::int64_t databases_ = 1;  ///< WriterStatus::databases that this watches
  bool watching_ = false;
  mutable std::mutex mutex_;  ///< guards what follows: Look replaces it while others ask
  Told not_watched_;          ///< why there is no drift watch
  std::unique_ptr<DriftWatch> watch_;
  std::optional<Feeds> feeds_;
  std::optional<ServiceWatch> self_;
  std::optional<EventLog> log_;
  FileIdentity journal_;
  std::optional<WriteAheadLogs> logs_beside_;
};

}  // namespace hydroscope
