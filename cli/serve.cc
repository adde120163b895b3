#include <malloc.h>
#include <systemd/sd-daemon.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <memory>
#include <nlohmann/json.hpp>

#include "acquisition/live_sources.h"
#include "alarms/feeds/feeds.h"
#include "cli/commands.h"
#include "host/output.h"
#include "host/real_clock.h"
#include "live/drift_watch.h"
#include "live/http_endpoint.h"
#include "live/live_service.h"
#include "live/log.h"
#include "live/service_watch.h"
#include "live/valve_checks.h"

namespace hydroscope {
namespace {

constexpr double kMegabyte = 1 << 20;

struct ServeArguments {
  LiveOptions live;
  ValveCheckOptions valve_check;
  int port = 9464;
  std::string log_level = "info";
  bool log_json = false, acknowledge = false;
  double raw_days = 7, raw_gigabytes = 4, min_free_megabytes = 64, queue_megabytes = 128,
         valve_check_hours = 0;
};

/// What the writer's thread frees behind a stroke the pipeline's thread needs at the next one: it is kept,
/// not given back to the system and fetched anew page by page while estimates wait.
void KeepFreedMemory() {
  mallopt(M_TRIM_THRESHOLD, 64 << 20);
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
}

/// Signals the service answers; blocked in every thread and waited for by one.
sigset_t Signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&set, signal);
  return set;
}

/// Feeds systemd's watchdog from the pipeline's thread, four times as often as it asks for.
LiveService::Heartbeat Watchdog(const Clock& clock) {
  std::uint64_t interval = 0;  // us
  if (sd_watchdog_enabled(0, &interval) <= 0) return {};
  return [clock, interval, fed = std::int64_t{0}]() mutable {
    const std::int64_t now = clock().monotonic_ns;
    if (now - fed < static_cast<std::int64_t>(interval) * 1000 / 4) return;
    fed = now;
    sd_notify(0, "WATCHDOG=1");
  };
}

/// One line per stored step on stdout, for those who must know what is safe: axis, run, strokes and rows of
/// it.
void PrintAcknowledged(const LiveWriter::Axis& axis, const WriteItem& item) {
  if (item.kind != WriteItem::Kind::kStep) return;
  const std::string line = fmt::format("stored {} run {} strokes {} rows {}\n", axis.name, axis.run,
                                       axis.strokes, item.step.rows_taken);
  if (std::fwrite(line.data(), 1, line.size(), stdout) == line.size()) std::fflush(stdout);
}

/// Watches for drift; nullptr, with the reason in `why`, if the model's parameters cannot be watched or
/// journal or rules are unusable: the strokes are stored all the same and can be judged later.
std::unique_ptr<PressMonitor> MakePressMonitor(const LiveOptions& options, const Machine& machine,
                                               std::string& why) {
  auto press =
      PressMonitor::Create(options.machine_file, machine.name, MachinesOfAxes(machine), options.database);
  const Status usable = press ? (*press)->watchable() : Status(tl::unexpected(press.error()));
  if (usable) return std::move(*press);
  why = usable.error().text;
  LogError("drift_is_not_watched", {{"why", usable.error().text}});
  return nullptr;
}

/// Limits of the machine file and the rules file beside it.
void Reload(LiveService& service, DriftWatch* watch, const LiveOptions& options) {
  sd_notify(0, "RELOADING=1");
  const Status reloaded = service.Reload();
  if (!reloaded) LogError("reload_refused", {{"why", reloaded.error().text}});
  std::string why;
  if (const auto model = LoadLiveModel(options.machine_file); reloaded && model && watch != nullptr)
    if (auto press = MakePressMonitor(options, (*model)->machine, why)) watch->Replace(std::move(press));
  if (reloaded) LogInfo("limits_reloaded");
  sd_notify(0, "READY=1");
}

/// What is told about the machine and about the service itself; `not_watched`: why there is no drift watch.
struct Surveillance {
  std::shared_ptr<HealthBoard> board = std::make_shared<HealthBoard>();
  std::unique_ptr<DriftWatch> watch;
  std::string not_watched;

  std::string WhyNotJudged() const { return watch ? watch->status().problem : not_watched; }
  /// Health of each axis is what the feeds read: that of the board.
  DriftWatchStatus Drift(const Machine& machine) const {
    DriftWatchStatus drift;
    if (watch) drift = watch->status();
    drift.problem = WhyNotJudged();
    for (int axis = 0; !watch && axis < AxisCount(machine); ++axis)
      drift.axes.push_back({.name = AxisMachineName(machine, axis), .health = {}, .alarms = {}});
    for (AxisHealth& axis : drift.axes) axis.health = board->Of(axis.name);
    return drift;
  }
};

/// Until a signal ends it.
void Wait(LiveService& service, Surveillance& told, const LiveOptions& options, const sigset_t& signals) {
  const Machine& machine = service.machine();
  ServiceWatch self(AlarmJournal::PathFor(options.database),
                    AxisCount(machine) > 1 ? machine.name : AxisMachineName(machine, 0), *told.board);
  for (;;) {
    const timespec patience{1, 0};
    const int signal = sigtimedwait(&signals, nullptr, &patience);
    if (signal == SIGHUP) Reload(service, told.watch.get(), options);
    if (signal == SIGTERM || signal == SIGINT) return;
    const LiveStatus status = service.status();
    self.Look(status.writer, told.WhyNotJudged(), Seconds(RealTime().wall_ns));
    sd_notifyf(0, "STATUS=%s, %lld strokes stored", WriterStateName(status.writer.state),
               static_cast<long long>(status.writer.strokes));
  }
}

int Run(ServeArguments& a) {
  if (const Status configured = ConfigureLog(a.log_level, a.log_json); !configured)
    return ReportError(configured.error());
  KeepFreedMemory();
  a.live.writer.raw = {static_cast<std::int64_t>(a.raw_gigabytes * 1024 * kMegabyte), a.raw_days * 86400};
  a.live.writer.min_free = static_cast<std::int64_t>(a.min_free_megabytes * kMegabyte);
  a.live.writer.queue_bytes = static_cast<std::int64_t>(a.queue_megabytes * kMegabyte);
  a.valve_check.period = a.valve_check_hours * 3600;
  if (AskService(SocketOf(a.live.database), "GET", "/status"))
    return ReportError(
        {ErrorKind::kBadInput,
         fmt::format("another service writes {} already; stop it first, or take another database",
                     a.live.database)});
  const sigset_t signals = Signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  auto created = LiveService::Create(
      a.live,
      [](const Machine& machine, const Clock& clock) {
        return MakeSources(machine, clock, static_cast<std::uint64_t>(clock().wall_ns));
      },
      RealTime, Watchdog(RealTime), a.acknowledge ? PrintAcknowledged : LiveWriter::Acknowledged());
  if (!created) return ReportError(created.error());
  LiveService& service = **created;
  Surveillance told;
  auto press = MakePressMonitor(a.live, service.machine(), told.not_watched);  // pairs journal and database
  if (press && !press->notice().empty()) LogWarning("journal_set_aside", {{"why", press->notice()}});
  const Feeds feeds = Feeds::Start(service.machine(), a.live.database, RealTime, told.board);
  ValveChecks checks(service, a.valve_check, RealTime);
  if (press)
    told.watch = std::make_unique<DriftWatch>(
        std::move(press),
        DriftWatch::Inputs{[&] { return service.status(); }, [&] { return checks.checking(); }, told.board},
        RealTime);
  const auto status = [&] {
    LiveStatus now = service.status();
    now.drift = told.Drift(service.machine());
    now.valve_check = checks.state();
    now.feeds = feeds.status();
    return now;
  };
  const auto endpoint = HttpEndpoint::Open(
      a.port, SocketOf(a.live.database),
      {[&] { return PrometheusText(status()); }, [&] { return StatusJson(status()).dump(1) + "\n"; },
       [&](const std::string& axis) { return checks.Request(axis); }});
  if (!endpoint) return ReportError(endpoint.error());
  if (const Status started = service.Start(); !started) return ReportError(started.error());
  checks.Start();
  if (told.watch) told.watch->Start();
  LogInfo("serving", {{"machine", service.machine().name},
                      {"axes", std::to_string(AxisCount(service.machine()))},
                      {"database", a.live.database},
                      {"port", std::to_string(a.port)}});
  sd_notify(0, "READY=1");
  Wait(service, told, a.live, signals);
  sd_notify(0, "STOPPING=1");
  LogInfo("stopping");
  checks.Stop();
  if (told.watch) told.watch->Stop();
  const bool stored = service.Stop();
  if (told.watch) told.watch->Finish();
  if (!stored) LogError("stopped_with_a_loss", {{"why", "what waited could not be written within 10 s"}});
  LogInfo("stopped");
  return stored ? kDone : kPartlyDone;
}

}  // namespace

void AddServeCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<ServeArguments>();
  ServeArguments& a = *arguments;
  CLI::App* command =
      app.add_subcommand("serve", "Watches a machine live: signals in, trends and Grams into the database");
  command->add_option("machine", a.live.machine_file, "Machine file with a [live] section (TOML)")
      ->required();
  command->add_option("--db,-d", a.live.database, "Trend database; created if it does not exist")->required();
  command->add_option("--port", a.port, "Prometheus text at http://127.0.0.1:PORT/metrics; 0 = none")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command->add_option("--raw-days", a.raw_days, "Raw window: days kept")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--raw-gb", a.raw_gigabytes, "Raw window: GB kept per axis; 0 = none")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--min-free", a.min_free_megabytes, "MB on the disk below which nothing is written")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--queue", a.queue_megabytes, "MB of raw rows that may wait for the disk")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--run-length", a.live.run_length, "s after which a run ends between two strokes")
      ->check(CLI::Range(10.0, 1e7))
      ->capture_default_str();
  command->add_option("--raw-period", a.live.raw_period, "s between two stored pieces of raw rows")
      ->check(CLI::Range(0.02, 60.0))
      ->capture_default_str();
  command
      ->add_option("--valve-check-every", a.valve_check_hours,
                   "Hours between valve checks of each axis; 0 = only on request")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      ->add_option("--valve-check-amplitude", a.valve_check.amplitude, "Valve check: share of full command")
      ->check(CLI::Range(0.001, 1.0))
      ->capture_default_str();
  command->add_option("--log-level", a.log_level, "debug, info, warning, error or off")
      ->capture_default_str();
  command->add_flag("--log-json", a.log_json, "Log as JSON, one object per line");
  command->add_flag("--acknowledge", a.acknowledge, "One line on stdout for each stored step");
  command->footer(
      "SIGTERM and SIGINT end it cleanly, SIGHUP takes over changed limits of the machine file. "
      "docs/serve.md\n"
      "tells how to run it under systemd and what every counter means.\n"
      "Examples:\n"
      "  hydroscope serve machines/press_live.toml --db press.db\n"
      "  hydroscope serve press.toml -d press.db --raw-days 3 --raw-gb 20 --valve-check-every 24\n"
      "  hydroscope status --db press.db");
  command->callback([arguments, &exit_code] { exit_code = Run(*arguments); });
}

}  // namespace hydroscope
