#include "simulator/die_cushion/press_server.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>

#include "simulator/dds/publisher.h"

namespace hydroscope {
namespace {

constexpr double kAmplitudeUnit = 1e-4;  // of the amplitude register

struct FastChannel {
  const char* name;
  const char* unit;
  double PressRow::*value;
};
constexpr FastChannel kFastChannels[] = {{"p_A", "Pa", &PressRow::p_A},
                                         {"p_B", "Pa", &PressRow::p_B},
                                         {"z", "m", &PressRow::z},
                                         {"y_v", "1", &PressRow::y_v},
                                         {"U_v", "V", &PressRow::U_v}};

std::size_t RowsOfBatch(const PressServer::Options& o) {
  const auto wanted = std::llround(o.batch / o.press.press.sample_period);
  const std::size_t most =
      SamplePublisher::kMostValues / (std::size(kFastChannels) * static_cast<std::size_t>(o.press.axes));
  return std::clamp<std::size_t>(static_cast<std::size_t>(std::max(1ll, wanted)), 1, most);
}

SamplePublisher::Options PublisherOptions(const PressServer::Options& o) {
  SamplePublisher::Options publisher{
      .network = *o.dds, .topic = o.topic, .session = o.session, .channels = {}, .units = {}};
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(o.press.axes); ++axis)
    for (const FastChannel& channel : kFastChannels) {
      publisher.channels.push_back(o.axes.empty() ? channel.name : o.axes[axis] + "/" + channel.name);
      publisher.units.emplace_back(channel.unit);
    }
  return publisher;
}

}  // namespace

Result<std::unique_ptr<PressServer>> PressServer::Create(const Options& options, Clock clock) {
  auto press = TRY(LivePress::Create(options.press));
  if (!options.axes.empty() && options.axes.size() != static_cast<std::size_t>(options.press.axes))
    return UsageError("{} names for {} axes", options.axes.size(), options.press.axes);
  if (!(options.speed >= 0.01 && options.speed <= 1000))
    return UsageError("speed {}; it must lie between 0.01 and 1000 times real time", options.speed);
  std::unique_ptr<PressServer> server(new PressServer(options, std::move(clock), std::move(press)));
  TRY(server->Open());
  return server;
}

PressServer::PressServer(const Options& options, Clock clock, std::unique_ptr<LivePress> press)
    : options_(options),
      clock_(std::move(clock)),
      start_(clock_()),
      batch_rows_(RowsOfBatch(options)),
      map_(options.press.axes, options.press.press.sample_period, options.session,
           options.modbus ? options.modbus->order : WordOrder::kAbcd),
      press_(std::move(press)) {}

PressServer::~PressServer() = default;

Status PressServer::Open() {
  if (options_.dds) {
    publisher_ = TRY(SamplePublisher::Create(PublisherOptions(options_)));
  }
  Simulate();
  if (!options_.modbus) return {};
  // The first client must already find samples in the registers.
  const auto fill = [this](std::span<std::uint16_t> registers) {
    map_.WriteHead(registers);
    WriteBatch(registers);
  };
  const auto on_coil = [this](int coil, std::span<std::uint16_t> registers) {
    if (coil != press_map::kSweepCoil) return;
    registers[press_map::kSweepStatus] = 0;  // not yet decided
    sweep_request_ = {registers[press_map::kSweepAxis] - 1,
                      registers[press_map::kSweepAmplitude] * kAmplitudeUnit};
  };
  modbus_ = TRY(ModbusServer::Start(options_.modbus->host, options_.modbus->port, fill, on_coil));
  PublishBatch();
  Simulate();
  return {};
}

/// A batch is sent when its last row is over: the first one, at the start, ends there.
std::int64_t PressServer::SourceTime(double t) const {
  const double since = t - static_cast<double>(batch_rows_) * options_.press.press.sample_period;
  return start_.wall_ns + std::llround((since * (1 + options_.clock_drift) + clock_jump_) * 1e9);
}

void PressServer::Run(std::stop_token stop, double seconds) {
  const double period = options_.press.press.sample_period;
  const double cycle_ns = static_cast<double>(batch_rows_) * period / options_.speed * 1e9;
  const auto cycles =
      static_cast<std::int64_t>(std::ceil(seconds / (static_cast<double>(batch_rows_) * period)));
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  for (std::int64_t cycle = modbus_ ? 1 : 0; cycle < cycles && !stop.stop_requested(); ++cycle) {
    const auto due = start_.monotonic_ns + static_cast<std::int64_t>(static_cast<double>(cycle) * cycle_ns);
    const std::int64_t early = due - clock_().monotonic_ns;
    if (early > 0) wake.wait_for(lock, stop, std::chrono::nanoseconds(early), [] { return false; });
    std::lock_guard guard(mutex_);
    if (quit_) return;
    counters_.latest = std::max(counters_.latest, static_cast<double>(clock_().monotonic_ns - due) * 1e-9);
    if (!frozen_) ServeBatch();
  }
}

void PressServer::TakeSweepRequest() {
  if (sweep_request_) press_->RequestSweep(sweep_request_->first, sweep_request_->second);
  sweep_request_.reset();
}

/// Ahead of the time at which the batch is due, so that it is sent then and not when it has been computed.
void PressServer::Simulate() {
  batch_.clear();
  values_.clear();
  for (std::size_t k = 0; k < batch_rows_; ++k) {
    const std::vector<PressRow>& rows = batch_.emplace_back(press_->Next());
    for (const PressRow& row : rows)
      for (const FastChannel& channel : kFastChannels) values_.push_back(row.*channel.value);
  }
}

void PressServer::ServeBatch() {
  if (modbus_)
    modbus_->Update([this](std::span<std::uint16_t> registers) {
      TakeSweepRequest();
      WriteBatch(registers);
    });
  PublishBatch();
  Simulate();
}

void PressServer::WriteBatch(std::span<std::uint16_t> registers) {
  for (std::size_t k = 0; k < batch_rows_; ++k) map_.WriteRecord(sequence_ + k, batch_[k], registers);
  const std::vector<PressRow>& latest = batch_.back();
  map_.WriteState(sequence_ + batch_rows_ - 1, SourceTime(latest.front().t), *press_, latest, registers);
}

void PressServer::PublishBatch() {
  if (publisher_ && !muted_) {
    const auto period_ns = std::llround(options_.press.press.sample_period * 1e9);
    ++counters_.batches;
    if (!publisher_->Write(sequence_, SourceTime(batch_.front().front().t), period_ns,
                           static_cast<std::uint32_t>(batch_rows_), values_))
      ++counters_.dropped_batches;
  }
  sequence_ += batch_rows_;
  counters_.rows += static_cast<std::int64_t>(batch_rows_);
}

Status PressServer::Do(const LiveCommand& command) {
  std::lock_guard lock(mutex_);
  struct Visitor {
    PressServer& s;
    Status operator()(const ChangeEffectCommand& c) {
      return s.press_->ChangeEffect(c.effect, c.axis, c.ramp);
    }
    Status operator()(const AddFaultCommand& c) { return s.press_->AddFault(c.fault, c.axis); }
    Status operator()(const PauseCommand& c) { return s.press_->SetPause(c.pause), Status{}; }
    Status operator()(const MuteCommand& c) { return s.muted_ = c.mute, Status{}; }
    Status operator()(const FreezeCommand& c) { return s.frozen_ = c.freeze, Status{}; }
    Status operator()(const ModbusFaultCommand& c) {
      if (!s.modbus_) return UsageError("this press serves no Modbus");
      return s.modbus_->SetFault(c.fault, c.delay), Status{};
    }
    Status operator()(const ClockCommand& c) { return s.clock_jump_ += c.jump, Status{}; }
    Status operator()(const QuitCommand&) { return s.quit_ = true, Status{}; }
  };
  return std::visit(Visitor{*this}, command);
}

PressServer::Counters PressServer::counters() const {
  std::lock_guard lock(mutex_);
  return counters_;
}

int PressServer::modbus_port() const { return modbus_ ? modbus_->port() : 0; }

}  // namespace hydroscope
