#include <CLI/CLI.hpp>
#include <csignal>
#include <ctime>
#include <fstream>
#include <memory>

#include "cli/commands.h"
#include "host/output.h"
#include "host/signals.h"
#include "page/page_server.h"
#include "simulator/die_cushion/log_format.h"
#include "simulator/die_cushion/press.h"

namespace hydroscope {
namespace {

constexpr double kExampleSeconds = 90;

/// A simulated press with a hidden effect, "" = none.
Status WriteExample(const std::string& effect, double size, const std::string& path) {
  PressOptions options;
  options.seconds = kExampleSeconds;
  options.seed = 4;
  if (!effect.empty()) options.effects = {{effect, size, {}}};
  std::ofstream file(path, std::ios::binary);
  std::string text(kPressLogHeader);
  PressGenerator generator(options);
  for (PressRow row; generator.Next(row);) {
    AppendPressLine(row, text);
    if (text.size() < 1 << 16) continue;
    file << text;
    text.clear();
  }
  file << text;
  file.close();
  if (!file) return InternalError("cannot write {}: is the disk full?", path);
  return {};
}

std::vector<ExampleLog> Examples() {
  const auto example = [](const char* id, const char* effect, double size) {
    return ExampleLog{id, [=](const std::string& path) { return WriteExample(effect, size, path); }};
  };
  return {example("press_a", "internal_leakage", 4e-12), example("press_b", "relief_valve", 3e-11),
          example("press_healthy", "", 0)};
}

/// Until SIGINT or SIGTERM, which `signals` blocks.
void Wait(PageServer& page, const sigset_t& signals) {
  constexpr timespec kPatience{5, 0};
  while (sigtimedwait(&signals, nullptr, &kPatience) < 0) page.KeepAlive();
}

Status RunOpen(PageOptions options) {
  const sigset_t signals = LeaveToSignalWait({SIGINT, SIGTERM});
  options.examples = Examples();
  const auto page = PageServer::Open(options);
  if (!page) return tl::unexpected(page.error());
  Say(fmt::format("{}  (Ctrl-C ends it)\n", (*page)->address()));
  Wait(**page, signals);
  return {};
}

}  // namespace

void AddOpenCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<PageOptions>();
  CLI::App* command = app.add_subcommand(
      "open", "The workbench in a browser: compare, see where the model fails, add what is missing");
  command->add_option("logs", options->logs,
                      "Logs of one machine (CSV, CSV.gz or MAT); without any, the page takes one");
  command->add_option("--machine,-m", options->machine,
                      "Machine file (TOML); without it, the page proposes one from the log");
  command->add_option("--port", options->port, "Port on 127.0.0.1; 0 = a free one")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command->footer(
      "Listens on this computer alone and changes no file until you save on the page.\n"
      "Examples:\n"
      "  hydroscope open\n"
      "  hydroscope open press.csv --machine press.toml");
  command->callback([options, &exit_code] {
    const Status ran = RunOpen(*options);
    exit_code = ran ? kDone : ReportError(ran.error());
  });
}

}  // namespace hydroscope
