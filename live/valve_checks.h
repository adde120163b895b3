#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "acquisition/modbus/valve_request.h"
#include "core/clock.h"
#include "core/records/sample_block.h"
#include "core/told.h"
#include "live/live_service.h"
#include "models/machine.h"

namespace hydroscope {

struct ValveCheckOptions {
  double period = 0;       ///< s between checks of each axis; 0: only on request
  double amplitude = 0.1;  ///< share of full command asked for
  double patience = 120;   ///< s a sweep may take
  double busy_retry = 60;  ///< s until a periodic check is tried again that met a busy press
};

/// The outcome of a sweep as a record for the database: figures if the record gave a model, else why not. A
/// sweep that was refused, broken off or never answered says nothing about the valve, and is not "measured".
ValveCheckRecord JudgeSweep(const SampleBlock& rows, const Machine& machine, SweepStatus end, double begin,
                            double amplitude);

/// Asks the controller for valve sweeps, periodically or on request, one at a time, and stores what the
/// aligned samples of the sweep tell. The controller alone decides; nothing is moved from here.
class ValveChecks {
 public:
  /// Takes the service's tap: construct before LiveService::Start, end before LiveService::Stop.
  ValveChecks(LiveService& service, const ValveCheckOptions& options, Clock clock);
  ~ValveChecks() { Stop(); }

  void Start();
  void Stop();
  /// `axis`: "cushion_1", or "" if the machine has no named axes. Error: no such axis, no sweep in the
  /// machine file, or one is waiting already.
  Status Request(const std::string& axis);
  /// For people; "" if checks are off and none was asked for.
  Told state() const;
  /// Axis whose valve is being swept, -1 if none is.
  int checking() const;

 private:
  void Run();
  std::optional<int> NextAxis();
  void Check(int axis);
  SweepStatus Ask(int axis, double& begin);
  void Record(int axis, const SampleBlock& block);
  bool Sleep(double seconds);
  void Note(const Told& state);

  LiveService& service_;
  const Machine& machine_;
  const ValveCheckOptions options_;
  const Clock clock_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<int> wanted_;
  std::vector<std::int64_t> next_;  ///< ns, monotonic, per axis
  Told state_;
  std::string problem_;
  int recording_ = -1;  ///< axis whose rows are kept
  SampleBlock rows_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace hydroscope
