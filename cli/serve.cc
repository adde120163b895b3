#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>

#include "acquisition/live_sources.h"
#include "cli/command_answer.h"
#include "cli/commands.h"
#include "core/json_text.h"
#include "core/secret_file.h"
#include "host/output.h"
#include "host/real_clock.h"
#include "host/signals.h"
#include "live/live_service.h"
#include "live/log.h"
#include "live/service_socket.h"
#include "live/surveillance.h"
#include "live/valve_checks.h"
#include "models/doubled_signals.h"
#include "page/page_server.h"

namespace hydroscope {
namespace {

constexpr double kMegabyte = 1 << 20;

struct ServeArguments {
  LiveOptions live;
  ValveCheckOptions valve_check;
  int port = 9464;
  std::string address = "127.0.0.1", certificate, key;
  std::vector<std::string> host_names;
  std::string log_level = "info";
  bool log_json = false, acknowledge = false;
  double raw_days = 7, raw_gigabytes = 4, min_free_megabytes = 64, queue_megabytes = 128,
         valve_check_hours = 0;
  bool all_stored = true;  ///< when it ended
};

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

/// One line per stored step on stdout, for those who must know what is safe: axis, run, strokes and rows of it.
void PrintAcknowledged(const LiveWriter::Axis& axis, const WriteItem& item) {
  if (item.kind != WriteItem::Kind::kStep) return;
  const std::string line = fmt::format("stored {} run {} strokes {} rows {}\n", axis.name, axis.run,
                                       axis.strokes, item.step.rows_taken);
  if (std::fwrite(line.data(), 1, line.size(), stdout) == line.size()) std::fflush(stdout);
}

/// Limits of the machine file and the rules file beside it.
void Reload(LiveService& service, Surveillance& surveillance, const LiveOptions& options) {
  sd_notify(0, "RELOADING=1");
  const Status reloaded = service.Reload();
  if (!reloaded) LogError("reload_refused", {{"why", reloaded.error().text}});
  if (const auto model = LoadLiveModel(options.machine_file); reloaded && model)
    surveillance.Reload((*model)->machine);
  if (reloaded) LogInfo("limits_reloaded");
  sd_notify(0, "READY=1");
}

/// What tools and monitoring ask beside the page: GET /metrics (Prometheus text), GET /status (JSON) and, by the socket only, POST
/// /valve_check?axis=NAME. Nothing: it is the page's to answer.
std::optional<HttpReply> AnswerTools(const HttpRequest& request, Surveillance& surveillance,
                                     ValveChecks& checks) {
  if (request.method == "GET" && request.path == "/metrics")
    return HttpReply{200, "text/plain; version=0.0.4", PrometheusText(surveillance.status())};
  if (request.method == "GET" && request.path == "/status")
    return HttpReply{200, "application/json", JsonText(StatusJson(surveillance.status()), 1) + "\n"};
  if (request.method != "POST" || request.path != "/valve_check" || !request.by_socket) return std::nullopt;
  const auto axis = request.query.find("axis");
  const Status asked = checks.Request(axis == request.query.end() ? "" : axis->second);
  return asked ? HttpReply{200, "text/plain", "asked\n"} : HttpReply{409, "text/plain", asked.error().text};
}

Result<std::string> ReadPem(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(file)), {});
  if (text.find("-----BEGIN ") == text.npos) return BadInput("{}: expected a PEM file", path);
  return text;
}

/// Where the page and the tools' socket are, as the arguments say.
Result<HttpListen> ListenOf(const ServeArguments& a) {
  HttpListen listen;
  if (a.port != 0) listen.port = a.port;
  listen.address = a.address;
  listen.socket = SocketOf(a.live.database);
  if (a.certificate.empty() != a.key.empty()) return UsageError("--certificate and --key belong together");
  if (a.certificate.empty()) return listen;
  TRY(CheckSecret(a.key, "--key"));
  for (const auto& [path, text] : {std::pair{a.certificate, &listen.certificate}, {a.key, &listen.key}}) {
    *text = TRY(ReadPem(path));
  }
  return listen;
}

enum class End { kSignal, kBeginAgain };

/// Until a signal ends it, or it has to begin again.
End Wait(LiveService& service, Surveillance& surveillance, PageServer& page, const LiveOptions& options,
         const sigset_t& signals) {
  for (;;) {
    const timespec patience{1, 0};
    const int signal = sigtimedwait(&signals, nullptr, &patience);
    if (signal == SIGHUP) Reload(service, surveillance, options);
    if (signal == SIGTERM || signal == SIGINT) return End::kSignal;
    if (!surveillance.Look()) return End::kBeginAgain;
    page.KeepAlive();
    const WriterStatus writer = service.status().writer;
    if (writer.state == WriterState::kWriting)  // else the database may keep readers waiting
      if (const auto taken = service.TakePromotions(); taken && *taken) surveillance.TakePromotions();
    sd_notifyf(0, "STATUS=%s, %lld stored", WriterStateName(writer.state),
               static_cast<long long>(writer.strokes));
  }
}

/// This program in place of itself, with its arguments. Returns only if the system does not let it.
ExitCode BeginAgain() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> words;
  for (std::string word; std::getline(file, word, '\0');) words.push_back(word);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execv("/proc/self/exe", arguments.data());
  LogError("ends", {{"why", std::string("it cannot begin again: ") + std::strerror(errno)}});
  return kOwnFault;
}

Result<End> Run(ServeArguments& a) {
  TRY(ConfigureLog(a.log_level, a.log_json));
  a.live.writer.raw = {static_cast<std::int64_t>(a.raw_gigabytes * 1024 * kMegabyte), a.raw_days * 86400};
  a.live.writer.min_free = static_cast<std::int64_t>(a.min_free_megabytes * kMegabyte);
  a.live.writer.queue_bytes = static_cast<std::int64_t>(a.queue_megabytes * kMegabyte);
  a.valve_check.period = a.valve_check_hours * 3600;
  if (AskService(SocketOf(a.live.database), "GET", "/status"))
    return BadInput("another service writes {} already; stop it first, or take another database",
                    a.live.database);
  const auto listen = TRY(ListenOf(a));
  const sigset_t signals = LeaveToSignalWait({SIGTERM, SIGINT, SIGHUP});  // one thread waits for them
  auto created = TRY(LiveService::Create(
      a.live,
      [](const Machine& machine, const Clock& clock) {
        return MakeSources(machine, clock, static_cast<std::uint64_t>(clock().wall_ns));
      },
      RealTime, Watchdog(RealTime), a.acknowledge ? PrintAcknowledged : LiveWriter::Acknowledged()));
  LiveService& service = *created;
  ValveChecks checks(service, a.valve_check, RealTime);
  Surveillance surveillance(service, checks, a.live, RealTime);
  ServicePageOptions page_options;
  page_options.listen = listen;
  page_options.host_names = a.host_names;
  page_options.watch.database = a.live.database;
  page_options.watch.machine_file = a.live.machine_file;
  page_options.watch.service = [&] { return StatusJson(surveillance.status()); };
  page_options.watch.valve_check = [&](const std::string& axis) { return checks.Request(axis); };
  page_options.service = [&](const HttpRequest& request) {
    return AnswerTools(request, surveillance, checks);
  };
  const auto page = TRY(PageServer::OpenForService(page_options));
  for (const DoubledSignals& doubled : DoubledSignalsOf(service.machine()))
    if (doubled.live) LogWarning("signals_from_one_place", {{"why", doubled.text.english}});
  TRY(service.Start());
  checks.Start();
  surveillance.Start();
  LogInfo("serving", {{"machine", service.machine().name},
                      {"axes", std::to_string(AxisCount(service.machine()))},
                      {"database", a.live.database},
                      {"address", a.address},
                      {"port", std::to_string(a.port)}});
  sd_notify(0, "READY=1");
  const End end = Wait(service, surveillance, *page, a.live, signals);
  sd_notify(0, "STOPPING=1");
  LogInfo("stopping");
  checks.Stop();
  surveillance.Stop();
  const bool stored = service.Stop();
  surveillance.Finish();
  if (!stored) LogError("stopped_with_a_loss", {{"why", "what waited could not be written within 10 s"}});
  LogInfo("stopped");
  a.all_stored = stored;
  return end;
}

Result<ExitCode> Serve(ServeArguments& a) {
  const auto end = Run(a);  // closes everything
  if (!end) return tl::unexpected(end.error());
  if (*end == End::kBeginAgain) return BeginAgain();
  return a.all_stored ? kDone : kPartlyDone;
}

}  // namespace

void AddServeCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<ServeArguments>();
  ServeArguments& a = *arguments;
  CLI::App* command =
      app.add_subcommand("serve", "Watches a machine live: signals in, trends and Grams into the database");
  command->option_defaults()->always_capture_default();
  command->add_option("MACHINE", a.live.machine_file, "Machine file with a [live] section (TOML)")
      ->required();
  command->add_option("--db,-d", a.live.database, "Trend database; created if it does not exist")->required();
  command
      ->add_option("--port", a.port,
                   "Page and Prometheus text: http://127.0.0.1:PORT/ and /metrics; 0 = none")
      ->check(CLI::Range(0, 65535));
  command->add_option(
      "--listen", a.address,
      "Address of the port; one that other computers reach (0.0.0.0, say) needs --certificate, and whoever "
      "looks has to log in (hydroscope users)");
  command->add_option("--certificate", a.certificate, "PEM file: the port then speaks TLS");
  command->add_option("--key", a.key, "PEM file of its private key");
  command->add_option("--host-name", a.host_names,
                      "Name under which other computers reach the page; repeatable");
  command->add_option("--raw-days", a.raw_days, "Raw window: days kept")->check(CLI::Range(0.0, 1e5));
  command->add_option("--raw-gb", a.raw_gigabytes, "Raw window: GB kept per axis; 0 = none")
      ->check(CLI::Range(0.0, 1e5));
  command->add_option("--min-free", a.min_free_megabytes, "MB on the disk below which nothing is written")
      ->check(CLI::Range(0.0, 1e9));
  command->add_option("--queue", a.queue_megabytes, "MB of raw rows that may wait for the disk")
      ->check(CLI::Range(0.1, 1e6));
  command->add_option("--run-length", a.live.run_length, "s after which a run ends between two strokes")
      ->check(CLI::Range(10.0, 1e7));
  command->add_option("--raw-period", a.live.raw_period, "s between two stored pieces of raw rows")
      ->check(CLI::Range(0.02, 60.0));
  command
      ->add_option("--valve-check-every", a.valve_check_hours,
                   "Hours between valve checks of each axis; 0 = only on request")
      ->check(CLI::Range(0.0, 1e5));
  command
      ->add_option("--valve-check-amplitude", a.valve_check.amplitude, "Valve check: share of full command")
      ->check(CLI::Range(0.001, 1.0));
  command->add_option("--log-level", a.log_level, "debug, info, warning, error or off");
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
  RunsAs(*command, exit_code, [arguments] { return Serve(*arguments); });
}

}  // namespace hydroscope
