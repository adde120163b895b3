#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "core/clock.h"
#include "core/registers.h"
#include "dds/participant.h"
#include "simulator/die_cushion/live_press.h"
#include "simulator/die_cushion/modbus/server.h"
#include "simulator/die_cushion/press_map.h"

namespace hydroscope {

class SamplePublisher;

/// What a press that is being served can be told; axes from 0, -1 = all; times in s.
struct ChangeEffectCommand {
  EffectSetting effect;
  int axis = -1;
  double ramp = 0;
};
struct AddFaultCommand {
  SensorFault fault;  ///< `start` from now
  int axis = -1;
};
struct PauseCommand {
  bool pause = false;
};
struct MuteCommand {
  bool mute = false;  ///< nothing is published by DDS
};
struct FreezeCommand {
  bool freeze = false;  ///< the press stands still: no new samples, registers as they are
};
struct ModbusFaultCommand {
  ModbusFault fault = ModbusFault::kNone;
  double delay = 0;
};
struct ClockCommand {
  double jump = 0;  ///< the press's clock jumps by this
};
struct QuitCommand {};
using LiveCommand = std::variant<ChangeEffectCommand, AddFaultCommand, PauseCommand, MuteCommand,
                                 FreezeCommand, ModbusFaultCommand, ClockCommand, QuitCommand>;

/// A simulated press on the wire: samples by DDS in batches, registers and burst ring by Modbus TCP, as fast
/// as the clock goes (docs/live_protocol.md).
class PressServer {
 public:
  struct Modbus {
    std::string host = "127.0.0.1";
    int port = 1502;  ///< 0 takes a free one
    WordOrder order = WordOrder::kAbcd;
  };
  struct Options {
    LivePress::Options press;
    std::vector<std::string> axes;  ///< names, as many as the press has axes; empty: channels without prefix
    std::uint64_t session = 1;      ///< another one in every life
    double speed = 1;               ///< times real time
    double batch = 0.01;            ///< s of samples in one message
    double clock_drift = 0;         ///< the press's clock runs faster by this share (1e-6 = 1 ppm)
    std::optional<DdsNetwork> dds;
    std::string topic = "hydroscope/samples";
    std::optional<Modbus> modbus;
  };
  struct Counters {
    std::int64_t rows = 0, batches = 0;
    std::int64_t dropped_batches = 0;  ///< not taken by DDS: a reader was too slow
    double latest = 0;  ///< s between a batch being due and its sending, at worst: our own computer is busy
  };

  static Result<std::unique_ptr<PressServer>> Create(const Options& options, Clock clock);
  ~PressServer();

  /// Serves for `seconds` of the press's time, until `stop`, or a QuitCommand.
  void Run(std::stop_token stop, double seconds);
  /// From any thread, between two batches.
  Status Do(const LiveCommand& command);
  Counters counters() const;
  int modbus_port() const;  ///< 0 without Modbus

 private:
  PressServer(const Options& options, Clock clock, std::unique_ptr<LivePress> press);
  Status Open();
  void Simulate();
  void WriteBatch(std::span<std::uint16_t> registers);
  void PublishBatch();
  void ServeBatch();
  void TakeSweepRequest();
  std::int64_t SourceTime(double t) const;

  Options options_;
  Clock clock_;
  HostTime start_;  // when the first batch is due
  std::size_t batch_rows_;
  PressMap map_;
  mutable std::mutex mutex_;  // guards everything below
  std::unique_ptr<LivePress> press_;
  std::uint64_t sequence_ = 0;                // of the first row that is not served yet
  std::vector<std::vector<PressRow>> batch_;  // the next to be served: for each row, all axes
  std::vector<double> values_;                // the same as it is published
  double clock_jump_ = 0;
  bool muted_ = false, frozen_ = false, quit_ = false;
  Counters counters_;
  // Axis from 0, amplitude; guarded by the registers' lock.
  std::optional<std::pair<int, double>> sweep_request_;
  std::unique_ptr<SamplePublisher> publisher_;
  std::unique_ptr<ModbusServer> modbus_;
};

}  // namespace hydroscope
