#include "acquisition/modbus/modbus_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "acquisition/list.h"
#include "acquisition/modbus/link.h"
#include "acquisition/modbus/read_plan.h"
#include "acquisition/modbus/retry.h"
#include "acquisition/modbus/ring_reader.h"
#include "acquisition/modbus/settings.h"
#include "acquisition/source.h"

namespace hydroscope {
namespace {

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

constexpr std::int64_t kHeartbeatLimit = 1'000'000'000;  // ns

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

using Registers = std::array<std::uint16_t, 125>;  // the most that one request gives

std::span<std::uint16_t> First(Registers& registers, int count) {
  return std::span(registers).first(static_cast<std::size_t>(count));
}

class RegisterSource : public PollingSource {
 public:
  RegisterSource(const Machine& machine, Clock clock, std::uint64_t seed)
      : PollingSource(*machine.Source<ModbusSpec>(), machine.Source<ModbusSpec>()->poll_period,
                      std::move(clock), seed),
        blocks_(PlanReads(machine)) {}
  ~RegisterSource() override { Stop(); }

 private:
  Status Check() const override { return {}; }
  std::string Name() const override { return "registers"; }
  SourceStatus Counters() const override { return counters_; }

  LinkOutcome Poll(ModbusLink& link) override {
    LinkOutcome worst = LinkOutcome::kDone;
    bool alive = true;
    for (const ReadBlock& block : blocks_) {
      Registers buffer;
      const auto registers = First(buffer, block.count);
      HostTime requested, received;
      const LinkOutcome outcome = Read(link, block.first, registers, requested, received);
      if (outcome != LinkOutcome::kDone) worst = outcome;
      if (!link.connected()) return outcome;
      if (outcome != LinkOutcome::kDone) continue;
      if (block.heartbeat) alive = Alive(registers[static_cast<std::size_t>(*block.heartbeat)], received);
      // Readings of a controller that stands still are old ones.
      if (alive && !block.values.empty()) Deliver(DecodeBlock(block, registers), requested, received);
    }
    return worst;
  }

  void Deliver(SampleBatch&& batch, HostTime requested, HostTime received) {
    batch.requested = requested;
    batch.received = received;
    batch.session = 1;
    {
      std::lock_guard lock(mutex_);
      batch.first_sequence = static_cast<std::uint64_t>(counters_.batches);
      ++counters_.batches;
      ++counters_.rows;
      counters_.last_received = received;
    }
    sink_(std::move(batch));
  }

  const std::vector<ReadBlock> blocks_;
  SourceStatus counters_;
};

class RingSource : public PollingSource {
 public:
  RingSource(const Machine& machine, Clock clock, std::uint64_t seed)
      : PollingSource(*machine.Source<ModbusSpec>(), machine.Source<ModbusSpec>()->ring->poll_period,
                      std::move(clock), seed),
        head_(RingReader::Head(*spec_.ring)),
        reader_(*spec_.ring, PlanRing(machine)) {}
  ~RingSource() override { Stop(); }

 private:
  Status Check() const override {
    if (head_) return {};
    return BadInput(
        "[live.modbus] ring: session, newest and time lie more than 125 registers apart; one request "
        "must reach them all");
  }
  std::string Name() const override { return "ring"; }
  SourceStatus Counters() const override { return reader_.counters(); }

  LinkOutcome Poll(ModbusLink& link) override {
    Registers buffer;
    HostTime requested, received;
    const auto head = First(buffer, head_->count);
    if (const LinkOutcome outcome = Read(link, head_->first, head, requested, received);
        outcome != LinkOutcome::kDone)
      return outcome;
    std::vector<RingReader::Request> requests;
    {
      std::lock_guard lock(mutex_);
      requests = reader_.Begin(head);
    }
    Alive(reader_.newest(), received);
    for (const RingReader::Request& request : requests) {
      const auto registers = First(buffer, request.registers.count);
      if (const LinkOutcome outcome = Read(link, request.registers.first, registers, requested, received);
          outcome != LinkOutcome::kDone)
        return outcome;
      Take(request, registers, requested, received);
    }
    return LinkOutcome::kDone;
  }

  void Take(const RingReader::Request& request, std::span<const std::uint16_t> registers, HostTime requested,
            HostTime received) {
    SampleBatch batch;
    {
      std::lock_guard lock(mutex_);
      reader_.Receive(request, registers, requested, received,
                      [&](SampleBatch&& b) { batch = std::move(b); });
    }
    if (batch.rows > 0) sink_(std::move(batch));
  }

  const std::optional<RingReader::Range> head_;
  RingReader reader_;
};

}  // namespace

std::unique_ptr<Source> MakeModbusRegisterSource(const Machine& machine, Clock clock, std::uint64_t seed) {
  return std::make_unique<RegisterSource>(machine, std::move(clock), seed);
}

std::unique_ptr<Source> MakeModbusRingSource(const Machine& machine, Clock clock, std::uint64_t seed) {
  return std::make_unique<RingSource>(machine, std::move(clock), seed);
}

std::vector<std::unique_ptr<Source>> MakeModbusSources(const Machine& machine, const Clock& clock,
                                                       std::uint64_t seed) {
  const auto any = [&](bool in_ring) {
    return std::any_of(machine.signals.begin(), machine.signals.end(), [&](const SignalSpec& signal) {
      const auto* origin = signal.From<ModbusOrigin>();
      return origin != nullptr && origin->in_ring == in_ring;
    });
  };
  std::vector<std::unique_ptr<Source>> sources;
  if (any(false)) sources.push_back(MakeModbusRegisterSource(machine, clock, seed));
  if (any(true)) sources.push_back(MakeModbusRingSource(machine, clock, seed + 1));
  return sources;
}

}  // namespace hydroscope
