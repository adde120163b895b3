#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "service/fit_log.h"
#include "service/commands.h"
#include "service/fit_output.h"
#include "service/fit_suspicion.h"
#include "service/output.h"

namespace hydroscope {

void AddFitCommand(CLI::App& app, int& exit_code) {
  struct Options {
    std::string log, machine, json;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("fit", "Physical parameters of the model from one log, with 95 % intervals");
  command->add_option("log", options->log, "Log of press strokes (CSV, CSV.gz or MAT)")->required();
  command->add_option("--machine,-m", options->machine, "Machine file (TOML)")->required();
  command->add_option("--json", options->json, "Write the result as JSON to this file; - is stdout");
  command->footer(
      "Examples:\n"
      "  hydroscope fit press.csv --machine machines/die_cushion.toml\n"
      "  hydroscope fit press.csv -m machines/die_cushion.toml --json -");
  command->callback([options, &exit_code] {
    const auto result = FitLog(options->log, options->machine);
    if (!result) {
      exit_code = ReportError(result.error());
      return;
    }
    const FitSuspicion suspicion = SuspectFit(result->log);
    if (options->json != "-") std::cout << FitText(*result) << SuspicionText(suspicion);
    if (options->json.empty()) return;
    nlohmann::json json = FitJson(*result);
    AddSuspicion(suspicion, json);
    if (const Status written = WriteJson(options->json, json); !written)
      exit_code = ReportError(written.error());
  });
}

}  // namespace hydroscope
