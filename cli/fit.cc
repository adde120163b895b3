#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "cli/command_answer.h"
#include "cli/commands.h"
#include "workbench/fit_log.h"
#include "workbench/fit_output.h"
#include "workbench/states/states_output.h"

namespace hydroscope {
namespace {

struct FitArguments {
  std::vector<std::string> logs;
  std::string machine, hold_out, json;
};

/// Says what was fitted, as text and as JSON.
template <typename Fit>
Status TellFit(const Result<Fit>& fit, const std::string& json) {
  if (!fit) return tl::unexpected(fit.error());
  return Answer(FitText(*fit), FitJson(*fit), json);
}

Status RunFit(const FitArguments& a) {
  if (HasStates(a.machine)) return TellFit(FitStatesLogs(a.logs, a.machine, a.hold_out), a.json);
  return TellFit(FitLogs(a.logs, a.machine, a.hold_out), a.json);
}

}  // namespace

void AddFitCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<FitArguments>();
  CLI::App* command = app.add_subcommand(
      "fit", "Physical parameters of the model from logs of one machine, with 95 % intervals");
  command->add_option("LOG", options->logs, "Logs of one machine (CSV, CSV.gz or MAT)")->required();
  command->add_option("--hold-out", options->hold_out,
                      "Log the model is not fitted to: its error on it is given as well");
  command->add_option("--machine,-m", options->machine, "Machine file (TOML)")->required();
  AddJsonOption(*command, options->json);
  command->footer(
      "Examples:\n"
      "  hydroscope fit press.csv --machine machines/die_cushion.toml\n"
      "  hydroscope fit X-ring257_*bar.csv -m machines/seal_friction.toml --hold-out X-ring257_3bar.csv\n"
      "  hydroscope fit press.csv -m machines/die_cushion.toml --json -");
  RunsAs(*command, exit_code, [options] { return RunFit(*options); });
}

}  // namespace hydroscope
