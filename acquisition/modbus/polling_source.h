#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "acquisition/modbus/link.h"
#include "acquisition/modbus/retry.h"
#include "acquisition/modbus/settings.h"
#include "acquisition/source.h"

namespace hydroscope {

/// What all Modbus sources have in common: a thread that connects, polls with a fixed period, and after a
/// fault makes a new connection with growing pauses. A connection counts as good only once something was
/// read: a process that hangs still accepts connections.
class PollingSource : public Source {
 public:
  PollingSource(const ModbusSpec& spec, double period, Clock clock, std::uint64_t seed);
  ~PollingSource() override;

  Status Start(Sink sink) override;
  SourceStatus status() const override;
  void Stop() override;

 protected:
  /// Settings that can never work.
  virtual Status Check() const = 0;
  /// One round of requests; kDone or kException keep the connection.
  virtual LinkOutcome Poll(ModbusLink& link) = 0;
  /// Counters of what was delivered; called with the lock held.
  virtual SourceStatus Counters() const = 0;
  virtual std::string Name() const = 0;

  /// Reads and stamps; counts what goes wrong.
  LinkOutcome Read(ModbusLink& link, int first, std::span<std::uint16_t> registers, HostTime& requested,
                   HostTime& received);
  /// The controller showed this number, which must change while it lives. True if it does.
  bool Alive(std::uint64_t heartbeat, HostTime now);

  const ModbusSpec spec_;
  const Clock clock_;
  Sink sink_;
  mutable std::mutex mutex_;  ///< of what status() tells

 private:
  void Run(const std::stop_token& stop);
  bool Wait(const std::stop_token& stop, double seconds);
  void Tell(bool connected, const Told& state);

  const double period_;
  Backoff backoff_;
  bool connected_ = false;
  Told state_{"not started", "nicht begonnen"};
  std::int64_t reconnects_ = 0, timeouts_ = 0, exceptions_ = 0, malformed_ = 0;
  std::uint64_t heartbeat_ = 0;
  HostTime heartbeat_changed_;
  bool still_ = false;
  std::mutex wake_mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;
};

}  // namespace hydroscope
