#include "acquisition/modbus/modbus_source.h"

#include <algorithm>
#include <array>

#include "acquisition/list.h"
#include "acquisition/modbus/polling_source.h"
#include "acquisition/modbus/read_plan.h"
#include "acquisition/modbus/ring_reader.h"

namespace hydroscope {
namespace {

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
