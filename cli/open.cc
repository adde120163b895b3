#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "cli/command_answer.h"
#include "cli/commands.h"
#include "cli/machines/press_log.h"
#include "cli/user_name.h"
#include "host/output.h"
#include "host/signals.h"
#include "live/service_socket.h"
#include "page/page_server.h"

namespace hydroscope {
namespace {

/// Those that end it: a terminal that is closed too, unless it was begun with nohup.
sigset_t EndingSignals() {
  struct sigaction hang_up = {};
  sigaction(SIGHUP, nullptr, &hang_up);
  return hang_up.sa_handler == SIG_IGN ? LeaveToSignalWait({SIGINT, SIGTERM})
                                       : LeaveToSignalWait({SIGINT, SIGTERM, SIGHUP});
}

/// Until one of `signals`, which are blocked.
void Wait(PageServer& page, const sigset_t& signals) {
  constexpr timespec kPatience{5, 0};
  while (sigtimedwait(&signals, nullptr, &kPatience) < 0) page.KeepAlive();
}

/// What the page works on is brought to its end; another signal ends the program without it.
void CloseOrLeave(std::unique_ptr<PageServer> page, const sigset_t& signals) {
  const std::jthread impatience([&signals](const std::stop_token& ended) {
    constexpr timespec kLook{0, 100'000'000};
    constexpr int kLooksUntilTold = 10;
    for (int look = 0; !ended.stop_requested(); ++look) {
      if (sigtimedwait(&signals, nullptr, &kLook) > 0) std::_Exit(kDone);
      if (look == kLooksUntilTold)
        SayBeside("ending once the work under way is done; Ctrl-C again ends at once\n");
    }
  });
  page.reset();
}

Status RunOpen(PageOptions options) {
  const sigset_t signals = EndingSignals();
  options.examples = ExamplePressLogs();
  options.watch.user = UserName();
  if (!options.watch.database.empty()) {
    if (!options.logs.empty()) return UsageError("open takes logs or --db, not both");
    options.watch.machine_file = std::exchange(options.machine, "");
    options.watch.service = [socket = SocketOf(options.watch.database)] {
      const auto answer = AskService(socket, "GET", "/status");
      return answer ? nlohmann::json::parse(*answer, nullptr, false) : nlohmann::json();
    };
    options.watch.valve_check = [socket =
                                     SocketOf(options.watch.database)](const std::string& axis) -> Status {
      const auto asked = AskService(socket, "POST", "/valve_check?axis=" + axis);
      return asked ? Status() : tl::unexpected(asked.error());
    };
  }
  auto page = TRY(PageServer::Open(options));
  Say(fmt::format("{}  (Ctrl-C ends it)\n", page->address()));
  Wait(*page, signals);
  CloseOrLeave(std::move(page), signals);
  return {};
}

}  // namespace

void AddOpenCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<PageOptions>();
  CLI::App* command = app.add_subcommand(
      "open", "In a browser: the workbench over logs, or overview, trends and alarms of a database");
  command->add_option("LOG", options->logs,
                      "Logs of one machine (CSV, CSV.gz or MAT); without any, the page takes one");
  command->add_option(
      "--machine,-m", options->machine,
      "Machine file (TOML); without it, the page proposes one from the log. With --db: the one beside which "
      "the rules file lies");
  command->add_option(
      "--db,-d", options->watch.database,
      "Trend database to watch, also while `hydroscope serve` writes it: overview, trends, alarms");
  command->add_option("--port", options->port, "Port on 127.0.0.1; 0 = a free one")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command->footer(
      "Listens on this computer alone and changes no file until you save on the page; what is\n"
      "done to an alarm goes into the journal at once, as by `hydroscope alarms`.\n"
      "Examples:\n"
      "  hydroscope open\n"
      "  hydroscope open press.csv --machine press.toml\n"
      "  hydroscope open --db press.db");
  RunsAs(*command, exit_code, [options] { return RunOpen(*options); });
}

}  // namespace hydroscope
