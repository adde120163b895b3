#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <iostream>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>

#include "acquisition/dds/dds_source.h"
#include "cli/command_answer.h"
#include "cli/commands.h"
#include "cli/machines/machines.h"
#include "cli/machines/served_press.h"
#include "core/units.h"
#include "host/output.h"
#include "host/real_clock.h"
#include "host/signals.h"
#include "replay/log_reader.h"
#include "simulator/dds/publisher.h"

namespace hydroscope {
namespace {

constexpr double kBatch = 0.01;  // s of rows in one message, as the simulated press sends them
constexpr double kDrain = 5;     // s that readers have for the last rows

struct SentLog {
  std::string log, machine, axis;
};

/// A signal as the log has it and the wire carries it: in the unit that the machine file states.
struct SentSignal {
  std::size_t signal;
  double scale, offset;  ///< SI = sent * scale + offset
  double Sent(double si) const { return (si - offset) / scale; }
};

Result<int> AxisNamed(const Machine& machine, const std::string& name) {
  const auto& axes = machine.live->axes;
  if (name.empty()) return 0;
  const auto found = std::ranges::find(axes, name);
  if (found == axes.end())
    return UsageError("--axis {}: the machine file has {}", name,
                      axes.empty() ? "no axes with names" : fmt::format("{}", fmt::join(axes, ", ")));
  return static_cast<int>(found - axes.begin());
}

/// Sends the rows of a log one after the other, each when it is due.
class LogSender {
 public:
  static Result<LogSender> Open(const SentLog& wanted) {
    const auto machine = TRY(LoadMachine(wanted.machine));
    const auto* dds = machine.Source<DdsSpec>();
    if (dds == nullptr)
      return BadInput("{}: a log is sent by DDS, and the file has no section [live.dds] that says where",
                      wanted.machine);
    const auto axis = TRY(AxisNamed(machine, wanted.axis));
    LogSender sender;
    sender.machine_ = std::make_unique<Machine>(MachineOfAxis(machine, axis));
    sender.reader_ = TRY(OpenLog(wanted.log, *sender.machine_));
    SamplePublisher::Options options{.network = NetworkOf(*dds),
                                     .topic = dds->topic,
                                     .session = static_cast<std::uint64_t>(RealTime().wall_ns / 1'000'000),
                                     .channels = {},
                                     .units = {},
                                     .name = "recorded log"};
    for (std::size_t s = 0; s < machine.signals.size(); ++s) {
      const SignalSpec& spec = machine.signals[s];
      if (spec.From<DdsOrigin>() == nullptr || spec.column.empty()) {
        sender.left_out_.push_back(spec.name);
        continue;
      }
      const Unit unit = FindUnit(spec.unit).value_or(Unit{});
      sender.signals_.push_back({s, spec.scale * unit.scale, spec.offset * unit.scale + unit.offset});
      options.channels.push_back(DdsChannelName(machine, static_cast<int>(s), axis));
      options.units.push_back(spec.unit);
    }
    if (sender.signals_.empty())
      return BadInput(
          "{}: no signal has both a column of the log and a name on the wire, e.g. z = {{ column = \"z\", "
          "dds = \"z\", unit = \"mm\" }}",
          wanted.machine);
    sender.publisher_ = TRY(SamplePublisher::Create(options));
    return sender;
  }

  std::string Announcement() const {
    std::string text =
        fmt::format("{} signals at {:g} Hz by DDS", signals_.size(), 1 / reader_->SamplePeriod());
    if (!left_out_.empty())
      text += fmt::format("; not sent, for want of a column or a DDS name: {}", fmt::join(left_out_, ", "));
    return text;
  }

  /// Begins with the first reader. Error: the log cannot be read further.
  Status Run(const std::stop_token& stop) {
    while (publisher_->readers() == 0)
      if (!Sleep(stop, 0.05)) return {};
    const HostTime start = RealTime();
    const double period = reader_->SamplePeriod();
    const auto rows_at_once = std::clamp<std::size_t>(static_cast<std::size_t>(std::lround(kBatch / period)),
                                                      1, SamplePublisher::kMostValues / signals_.size());
    SampleBlock block;
    std::vector<double> values;
    while (!stop.stop_requested()) {
      const auto read = TRY(reader_->Read(block, rows_at_once));
      if (read == 0) break;
      values.clear();
      for (std::size_t row = 0; row < read; ++row)
        for (const SentSignal& s : signals_) values.push_back(s.Sent(block.signal[s.signal][row]));
      const double since = static_cast<double>(rows_) * period, length = static_cast<double>(read) * period;
      if (!Sleep(stop, since + length - Seconds(RealTime().monotonic_ns - start.monotonic_ns))) break;
      const bool taken =
          publisher_->Write(static_cast<std::uint64_t>(rows_), start.wall_ns + Nanoseconds(since),
                            Nanoseconds(period), static_cast<std::uint32_t>(read), values);
      if (!taken) dropped_ += static_cast<std::int64_t>(read);
      rows_ += static_cast<std::int64_t>(read);
    }
    publisher_->Drain(kDrain);
    return {};
  }

  std::string Outcome() const { return fmt::format("sent {} rows, {} dropped", rows_ - dropped_, dropped_); }

 private:
  static std::int64_t Nanoseconds(double s) { return std::llround(s * 1e9); }
  /// False: told to stop.
  static bool Sleep(const std::stop_token& stop, double seconds) {
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable_any wake;
    if (seconds > 0) wake.wait_for(lock, stop, std::chrono::duration<double>(seconds), [] { return false; });
    return !stop.stop_requested();
  }

  std::unique_ptr<Machine> machine_;  ///< of the axis; the reader keeps to it
  std::unique_ptr<LogReader> reader_;
  std::vector<SentSignal> signals_;
  std::vector<std::string> left_out_;
  std::unique_ptr<SamplePublisher> publisher_;
  std::int64_t rows_ = 0, dropped_ = 0;
};

Status SendLog(const SentLog& wanted) {
  const sigset_t signals = LeaveToSignalWait({SIGINT, SIGTERM});
  auto sender = TRY(LogSender::Open(wanted));
  std::stop_source stop;
  const std::jthread waits([&signals, stop](const std::stop_token& done) mutable {
    const timespec look{.tv_sec = 0, .tv_nsec = 100'000'000};
    while (!done.stop_requested())
      if (sigtimedwait(&signals, nullptr, &look) > 0) stop.request_stop();
  });
  if (!IsQuiet()) std::cout << "waiting for a reader: " << sender.Announcement() << std::endl;
  const Status sent = sender.Run(stop.get_token());
  if (!IsQuiet()) std::cout << sender.Outcome() << std::endl;
  return sent;
}

/// `simulate log`: a recorded log, sent as if its machine were at work now.
void AddSimulateLog(CLI::App& simulate, int& exit_code) {
  CLI::App* app =
      simulate.add_subcommand("log", "A recorded log, sent live as if its machine were at work now");
  auto a = std::make_shared<SentLog>();
  app->add_option("LOG", a->log, "Log to send, CSV or MAT")->required()->type_name("LOG");
  app->add_option("--serve", a->machine,
                  "Machine file: its columns say what the log holds, its [live.dds] where it is sent")
      ->required()
      ->type_name("FILE");
  app->add_option("--axis", a->axis, "Axis that the log is sent as, if the machine has several; the first");
  app->footer(
      "Rows begin with the first reader and come at the rate of the log, by DDS (docs/live_protocol.md). A\n"
      "signal is sent that has a column and a name on the wire: z = { column = \"z\", dds = \"z\" }.\n"
      "Examples:\n"
      "  hydroscope simulate log tank.csv --serve tank_live.toml\n"
      "  hydroscope simulate log press.csv --serve press.toml --axis left");
  RunsAs(*app, exit_code, [a] { return SendLog(*a); });
}

}  // namespace

void AddSimulateCommand(CLI::App& app, int& exit_code) {
  CLI::App* simulate = app.add_subcommand("simulate", "Logs of simulated machines whose truth is known");
  simulate->require_subcommand(1);
  AddSimulatePress(*simulate, exit_code);
  AddSimulateValve(*simulate, exit_code);
  AddSimulateLog(*simulate, exit_code);
#define HYDROSCOPE_ADD_SIMULATION(Name) AddSimulate##Name(*simulate, exit_code);
  HYDROSCOPE_SIMULATED_MACHINES(HYDROSCOPE_ADD_SIMULATION)
#undef HYDROSCOPE_ADD_SIMULATION
}

}  // namespace hydroscope
