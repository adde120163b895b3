#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "host/output.h"
#include "workbench/fit_log.h"
#include "workbench/fit_output.h"

namespace hydroscope {

void AddFitCommand(CLI::App& app, int& exit_code) {
  struct Options {
    std::vector<std::string> logs;
    std::string machine, hold_out, json;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "fit", "Physical parameters of the model from logs of one machine, with 95 % intervals");
  command->add_option("logs", options->logs, "Logs of one machine (CSV, CSV.gz or MAT)")->required();
  command->add_option("--hold-out", options->hold_out,
                      "Log the model is not fitted to: its error on it is given as well");
  command->add_option("--machine,-m", options->machine, "Machine file (TOML)")->required();
  command->add_option("--json", options->json, "Write the result as JSON to this file; - is stdout");
  command->footer(
      "Examples:\n"
      "  hydroscope fit press.csv --machine machines/die_cushion.toml\n"
      "  hydroscope fit X-ring257_*bar.csv -m machines/seal_friction.toml --hold-out X-ring257_3bar.csv\n"
      "  hydroscope fit press.csv -m machines/die_cushion.toml --json -");
  command->callback([options, &exit_code] {
    const auto result = FitLogs(options->logs, options->machine, options->hold_out);
    if (!result) {
      exit_code = ReportError(result.error());
      return;
    }
    if (options->json != "-") Say(FitText(*result));
    if (options->json.empty()) return;
    if (const Status written = WriteJson(options->json, FitJson(*result)); !written)
      exit_code = ReportError(written.error());
  });
}

}  // namespace hydroscope
