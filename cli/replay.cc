#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command_answer.h"
#include "cli/commands.h"
#include "host/output.h"
#include "live/service_socket.h"
#include "review/replay_output.h"
#include "review/replay_runner.h"

namespace hydroscope {
namespace {

struct ReplayArguments {
  ReplayOptions options;
  std::string json;
};

Result<ExitCode> Run(const ReplayArguments& arguments) {
  if (AskService(SocketOf(arguments.options.database), "GET", "/status"))
    return BadInput("a service writes {}; stop it first, or replay into another database",
                    arguments.options.database);
  const auto outcome = TRY(RunReplay(arguments.options));
  TRY(Answer(ReplayText(arguments.options, outcome), ReplayJson(arguments.options, outcome), arguments.json));
  for (const ReplayOutcome& machine : outcome.machines)
    for (const LogReplay& replay : machine.logs)
      if (replay.status == ReplayStatus::kFailed)
        std::cerr << "hydroscope: left out: " << replay.problem << "\n";
  if (outcome.Failed()) return kWrongInput;
  return outcome.Complete() ? kDone : kPartlyDone;
}

}  // namespace

void AddReplayCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<ReplayArguments>();
  ReplayOptions& o = arguments->options;
  CLI::App* command = app.add_subcommand(
      "replay", "The live pipeline over historical logs: trends into a database, and a report");
  command->add_option("LOG", o.logs, "Logs in the order of their recording (CSV, CSV.gz or MAT)")->required();
  command->add_option("--machine,-m", o.machine_file, "Machine file (TOML)")->required();
  command->add_option("--db,-d", o.database, "Trend database; created if it does not exist")->required();
  command->add_option("--axis,-a", o.axis,
                      "Axis of the press the logs are of, unless a log names its own (LOG#AXIS)");
  command->add_option("--report,-r", o.report, "Write a maintenance report (one HTML page) to this file");
  AddJsonOption(*command, arguments->json);
  command->footer(
      "Each log continues where the machine's log before it ended: thirty logs are one history. A log that is\n"
      "in the database already is not stored twice; after a crash, call the same command again. A log that\n"
      "cannot be read does not stop the others: exit code 4, with what was left out.\n"
      "Of a press whose machine file names axes each log belongs to one of them (--axis, LOG#AXIS), or to all\n"
      "(columns with {axis} in their names); what all axes show together is told of the press, in whatever\n"
      "order they are replayed.\n"
      "Examples:\n"
      "  hydroscope replay press.csv --machine press.toml --db press.db --report press.html\n"
      "  hydroscope replay logs/2024-*.csv.gz -m press.toml --db press.db --json result.json\n"
      "  hydroscope replay left.csv#left right.csv#right -m press.toml --db press.db\n"
      "  hydroscope replay logs/left/*.csv --axis left -m press.toml --db press.db");
  RunsAs(*command, exit_code, [arguments] { return Run(*arguments); });
}

}  // namespace hydroscope
