#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "service/commands.h"
#include "service/explain_output.h"
#include "service/output.h"

namespace hydroscope {

void AddExplainCommand(CLI::App& app, int& exit_code) {
  struct Options {
    std::string log, machine, json;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "explain", "Which physical effect the model misses: verdict, evidence and what to do next");
  command->add_option("log", options->log, "Log of press strokes (CSV, CSV.gz or MAT)")->required();
  command->add_option("--machine,-m", options->machine, "Machine file (TOML)")->required();
  command->add_option("--json", options->json, "Write the result as JSON to this file; - is stdout");
  command->footer(
      "Verdicts: adequate, named, ambiguous, unknown (docs/workbench.md). The exit code is 0 for all four.\n"
      "Examples:\n"
      "  hydroscope explain press.csv --machine machines/die_cushion.toml\n"
      "  hydroscope explain press.csv -m machines/die_cushion.toml --json -");
  command->callback([options, &exit_code] {
    const auto result = ExplainLog(options->log, options->machine);
    if (!result) {
      exit_code = ReportError(result.error());
      return;
    }
    if (options->json != "-") std::cout << ExplainText(*result);
    if (!options->json.empty())
      if (const Status written = WriteJson(options->json, ExplainJson(*result)); !written)
        exit_code = ReportError(written.error());
  });
}

}  // namespace hydroscope
