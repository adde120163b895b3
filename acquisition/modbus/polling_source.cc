#include "acquisition/modbus/polling_source.h"

#include <fmt/format.h>

#include <algorithm>

namespace hydroscope {
namespace {

constexpr std::int64_t kHeartbeatLimit = 1'000'000'000;  // ns

}  // namespace

PollingSource::PollingSource(const ModbusSpec& spec, double period, Clock clock, std::uint64_t seed)
    : spec_(spec),
      clock_(std::move(clock)),
      period_(period),
      backoff_(spec.retry_first, spec.retry_limit, seed) {}

PollingSource::~PollingSource() = default;

Status PollingSource::Start(Sink sink) {
  TRY(Check());
  sink_ = std::move(sink);
  thread_ = std::jthread([this](std::stop_token stop) { Run(stop); });
  return {};
}

void PollingSource::Stop() { thread_ = {}; }

SourceStatus PollingSource::status() const {
  std::lock_guard lock(mutex_);
  SourceStatus status = Counters();
  status.name = fmt::format("modbus {}:{} {}", spec_.host, spec_.port, Name());
  status.connected = connected_ && !still_;
  status.state = still_ && connected_
                     ? hydroscope::Tell("the controller answers, but its heartbeat stands still",
                                        "die Steuerung antwortet, aber ihr Lebenszeichen steht still")
                     : state_;
  status.reconnects = reconnects_;
  status.timeouts = timeouts_;
  status.exceptions = exceptions_;
  status.malformed += malformed_;
  return status;
}

bool PollingSource::Wait(const std::stop_token& stop, double seconds) {
  std::unique_lock lock(wake_mutex_);
  wake_.wait_for(lock, stop, std::chrono::duration<double>(std::max(seconds, 0.0)), [] { return false; });
  return !stop.stop_requested();
}

void PollingSource::Tell(bool connected, const Told& state) {
  std::lock_guard lock(mutex_);
  connected_ = connected;
  state_ = state;
}

void PollingSource::Run(const std::stop_token& stop) {
  ModbusLink link(spec_.host, spec_.port, spec_.unit, spec_.timeout);
  Tell(false, {"connecting", "verbindet"});
  bool first = true;
  while (!stop.stop_requested()) {
    if (link.Connect() == LinkOutcome::kDone) {
      if (!first) {
        std::lock_guard lock(mutex_);
        ++reconnects_;
      }
      first = false;
      while (link.connected()) {
        const std::int64_t begin = clock_().monotonic_ns;
        const LinkOutcome outcome = Poll(link);
        if (outcome == LinkOutcome::kDone) {
          backoff_.Reset();
          Tell(true, {"receiving", "empfängt"});
        } else {
          Tell(outcome == LinkOutcome::kException, link.problem());
        }
        const double spent = static_cast<double>(clock_().monotonic_ns - begin) * 1e-9;
        if (!link.connected() || !Wait(stop, period_ - spent)) break;
      }
    } else {
      Tell(false, link.problem());
    }
    if (!Wait(stop, backoff_.Next())) break;
  }
  Tell(false, {"stopped", "angehalten"});
}

LinkOutcome PollingSource::Read(ModbusLink& link, int first, std::span<std::uint16_t> registers,
                                HostTime& requested, HostTime& received) {
  requested = clock_();
  const LinkOutcome outcome = link.Read(first, registers);
  received = clock_();
  std::lock_guard lock(mutex_);
  timeouts_ += outcome == LinkOutcome::kTimeout;
  exceptions_ += outcome == LinkOutcome::kException;
  malformed_ += outcome == LinkOutcome::kGarbage;
  return outcome;
}

bool PollingSource::Alive(std::uint64_t heartbeat, HostTime now) {
  std::lock_guard lock(mutex_);
  if (heartbeat != heartbeat_ || heartbeat_changed_.monotonic_ns == 0) {
    heartbeat_ = heartbeat;
    heartbeat_changed_ = now;
  }
  still_ = now.monotonic_ns - heartbeat_changed_.monotonic_ns > kHeartbeatLimit;
  return !still_;
}

}  // namespace hydroscope
