#include "cli/machines/served_press.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <iostream>
#include <thread>

#include "acquisition/dds/dds_source.h"
#include "acquisition/modbus/settings.h"
#include "cli/machines/live_command.h"
#include "host/output.h"
#include "host/signals.h"
#include "simulator/die_cushion/press_map.h"

namespace hydroscope {
namespace {

/// s, integration step of a served press: fourth order needs no finer one beside its noise, and what it takes of the
/// processor is missing where service and press share a computer.
constexpr double kServedStep = 100e-6;

HostTime Now() {
  const auto ns = [](auto time) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
  };
  return {ns(std::chrono::steady_clock::now()), ns(std::chrono::system_clock::now())};
}

std::vector<std::string> AxisNames(const Machine& machine, int axes) {
  std::vector<std::string> names = machine.live->axes;
  while (static_cast<int>(names.size()) < axes) names.push_back(fmt::format("axis_{}", names.size() + 1));
  names.resize(static_cast<std::size_t>(axes));
  return names;
}

/// The ring of the machine file must be the one that the press has.
Status CheckRing(const ModbusRingSpec& ring, const PressServer::Options& options) {
  using namespace press_map;
  const PressMap map(options.press.axes, options.press.press.sample_period, options.session,
                     WordOrder::kAbcd);
  if (!map.has_ring())
    return UsageError("a press of {} axes has no ring in its registers; at most {} axes fit",
                      options.press.axes, kMostRingAxes);
  const bool same = ring.session == kSession && ring.newest == kNewest && ring.first == kRing &&
                    ring.records == map.ring_records() && ring.width == map.ring_width();
  if (same) return {};
  return BadInput(
      "[live.modbus] ring: the simulated press of {} axes has ring = {{ session = {}, newest = {}, time = "
      "{}, first = {}, records = {}, width = {}, period = {} }}",
      options.press.axes, kSession, kNewest, kTime, kRing, map.ring_records(), map.ring_width(),
      options.press.press.sample_period);
}

/// Reads commands and signals until the press has stopped.
class Control {
 public:
  Control(PressServer& server, std::stop_source stop, const sigset_t& signals)
      : server_(server),
        stop_(std::move(stop)),
        signals_(signals),
        thread_([this](std::stop_token done) { Listen(done); }) {}

 private:
  static constexpr int kLook = 100;  // ms between two looks at signals

  void Listen(const std::stop_token& done) {
    const timespec at_once{};
    bool open = true;
    while (!done.stop_requested()) {
      if (sigtimedwait(&signals_, nullptr, &at_once) > 0) stop_.request_stop();
      pollfd input{STDIN_FILENO, POLLIN, 0};
      if (poll(&input, open ? 1 : 0, kLook) <= 0) continue;
      char bytes[4096];
      const ssize_t count = read(STDIN_FILENO, bytes, sizeof(bytes));
      if (count <= 0) open = false;  // nobody is there any more; the press goes on
      for (ssize_t k = 0; k < count; ++k) {
        if (bytes[k] != '\n') {
          line_ += bytes[k];
          continue;
        }
        Do(line_);
        line_.clear();
      }
    }
  }

  void Do(const std::string& line) {
    const auto command = ParseLiveCommand(line);
    const Status status = command ? server_.Do(*command) : tl::unexpected(command.error());
    std::cout << (status ? "ok " + line : "error " + status.error().text) << std::endl;
  }

  PressServer& server_;
  std::stop_source stop_;
  sigset_t signals_;
  std::string line_;
  std::jthread thread_;
};

std::string Announcement(const PressServer::Options& o) {
  std::string text =
      fmt::format("serving {} {} at {:g} Hz, {:g} times real time", o.press.axes,
                  o.press.axes == 1 ? "axis" : "axes", 1 / o.press.press.sample_period, o.speed);
  if (o.dds) text += fmt::format("; DDS domain {}, topic {}", o.dds->domain, o.topic);
  if (o.modbus) text += fmt::format("; Modbus {}:{}", o.modbus->host, o.modbus->port);
  return text + fmt::format("; session {}", o.session);
}

}  // namespace

Result<PressServer::Options> ServeOptions(const ServedPress& arguments, const PressOptions& press,
                                          const Machine& machine) {
  const auto* dds = machine.Source<DdsSpec>();
  const auto* modbus = machine.Source<ModbusSpec>();
  if (dds == nullptr && modbus == nullptr)
    return BadInput(
        "{}: a machine that is served needs a section [live] with [live.dds], [live.modbus] or both",
        arguments.machine);
  const LiveSpec& live = *machine.live;
  PressServer::Options options;
  options.press = {.press = press, .axes = arguments.axes, .work = arguments.work, .pause = arguments.pause};
  options.press.press.max_step = kServedStep;
  if (arguments.axes == 0) options.press.axes = AxisCount(machine);
  if (arguments.axes != 0 || !live.axes.empty()) options.axes = AxisNames(machine, options.press.axes);
  options.speed = arguments.speed;
  options.clock_drift = arguments.clock_drift * 1e-6;
  if (dds != nullptr) {
    options.topic = dds->topic;
    options.dds = NetworkOf(*dds);
  }
  if (modbus != nullptr) {
    options.modbus = {.host = modbus->host, .port = modbus->port, .order = modbus->order};
    if (modbus->ring) TRY(CheckRing(*modbus->ring, options));
  }
  return options;
}

Status ServePress(const ServedPress& arguments, PressOptions press) {
  const auto machine = TRY(LoadMachine(arguments.machine));
  auto options = TRY(ServeOptions(arguments, press, machine));
  options.session = static_cast<std::uint64_t>(Now().wall_ns / 1'000'000);

  const sigset_t signals = LeaveToSignalWait({SIGINT, SIGTERM});  // Control waits for them

  auto server = TRY(PressServer::Create(options, Now));
  if (!IsQuiet()) std::cout << Announcement(options) << std::endl;
  std::stop_source stop;
  {
    const Control control(*server, stop, signals);
    server->Run(stop.get_token(), press.seconds);
  }
  const PressServer::Counters counters = server->counters();
  if (IsQuiet()) return {};
  std::cout << fmt::format("stopped after {} rows; {} batches published, {} dropped, at worst {:.1f} ms late",
                           counters.rows, counters.batches, counters.dropped_batches, counters.latest * 1e3)
            << std::endl;
  return {};
}

}  // namespace hydroscope
