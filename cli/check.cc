#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "acquisition/live_sources.h"
#include "cli/command_answer.h"
#include "cli/commands.h"
#include "host/output.h"
#include "host/real_clock.h"
#include "live/check_live.h"
#include "models/machine_kind.h"
#include "workbench/check_output.h"

namespace hydroscope {
namespace {

struct CheckArguments {
  std::string log, machine, json, live;
  double seconds = 10;
};

/// Listens to the machine in place of reading a log.
Result<ExitCode> RunLive(const CheckArguments& arguments) {
  const auto model = TRY(LoadLiveModel(arguments.live));
  const auto check = TRY(CheckLive(
      model->machine, arguments.seconds,
      [](const Machine& machine, const Clock& clock) { return MakeSources(machine, clock, 1); }, RealTime));
  TRY(Answer(LiveCheckText(check), LiveCheckJson(check), arguments.json));
  return check.Clean() ? kDone : kPartlyDone;
}

Result<ExitCode> Run(const CheckArguments& arguments) {
  if (!arguments.live.empty()) return RunLive(arguments);
  if (arguments.log.empty() || arguments.machine.empty())
    return UsageError("check needs LOG and --machine, or --live MACHINE");
  const auto check = TRY(CheckLog(arguments.log, arguments.machine));
  TRY(Answer(CheckText(check, arguments.machine), CheckJson(check), arguments.json));
  const bool no_stroke = KindOf(check.machine).build != nullptr && check.driving.strokes == 0;
  return check.Clean() && !no_stroke && !check.NothingIdentified() ? kDone : kPartlyDone;
}

}  // namespace

void AddCheckCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<CheckArguments>();
  CLI::App* command = app.add_subcommand(
      "check", "Signal quality, gate and excitation of a log: what can be identified from it");
  command->add_option("LOG", arguments->log, "Log (CSV, CSV.gz or MAT), or raw window (press.db#axis)");
  command->add_option("--machine,-m", arguments->machine, "Machine file (TOML)");
  command->add_option("--live", arguments->live,
                      "Listen to the machine of this machine file in place of a log");
  command->add_option("--seconds", arguments->seconds, "--live: s to listen")
      ->check(CLI::Range(1.0, 3600.0))
      ->capture_default_str();
  AddJsonOption(*command, arguments->json);
  command->footer(
      "Exit code 4: rows or values are bad and would be left out, there is no stroke, no "
      "parameter can be identified, or nothing moves that frf would measure.\n"
      "Examples:\n"
      "  hydroscope check press.csv --machine press.toml\n"
      "  hydroscope check press.csv -m press.toml --json check.json\n"
      "  hydroscope check --live machines/press_live.toml");
  RunsAs(*command, exit_code, [arguments] { return Run(*arguments); });
}

}  // namespace hydroscope
